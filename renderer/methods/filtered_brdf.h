#pragma once

#include <vector>

#include "renderer/methods/host_method.h"
#include "renderer/methods/lobe_sampling.h"
#include "renderer/methods/ray_light.h"

namespace lumifield {

/// Filtered importance sampling (Colbert, Křivánek, GPU Gems 3, ch. 20) on the light field: N directions are drawn as
/// the receiver itself reflects, N of its lobe and N of its diffuse part, and the light from there is looked up,
///
///     E ≈ 1/N Σ_k L(ω_k) n·ω_k/pdf(ω_k),   G ≈ 1/N Σ_k L(ω_k) f(ω_k) n·ω_k/pdf(ω_k)
///
/// Filtered, a direction stands for the solid angle Ω = 1/(N pdf) about it, a square of side w = √(Ω |u−p|²/cosθ) on U,
/// and L is the average over that (RayLight). Averages of C and Φ are multiplied, which is not the average of the
/// product, and Ω is taken as constant in a footprint: a bias that falls with N. Unfiltered, samples are unbiased.
class FilteredBrdf final : public HostMethod {
 public:
  FilteredBrdf(const LightField& light_field, const MethodSettings& settings);

  using HostMethod::estimate;
  Result<std::vector<double>> light(const Receiver& receiver, std::uint32_t number, const Look& look) const override;
  /// Unfiltered: the deviation of independent samples, √(1/N ∫ (L f n·ω)²/pdf dω). Filtered: that of the filtered
  /// light, and its mean's distance from ∫ L f n·ω dω, both from 16 N and more points of the same density.
  Result<Estimate> estimate(const Receiver& receiver, std::uint32_t number, const Look& look) const override;

 private:
  int samples() const;
  /// Adds to values [first, …) of the receiver.
  void add(const ReceiverView& view, const LobeDistribution& draws, std::uint32_t number, LobeDraws kind,
           std::span<double> values) const;
  void add_stated(const ReceiverView& view, const LobeDistribution& draws, std::span<double> stated) const;

  MethodSettings settings_;
  RayLight rays_;
  std::vector<LobePoint> diffuse_, glossy_;
};

/// Where a ray to a receiver leaves U, mm, and the square root of |u−p|²/cosθ there, mm: the side of the square that
/// one steradian shows. Empty where it does not come from U.
struct RayStart {
  Vec2 u_mm;
  double side_mm;
};
std::optional<RayStart> ray_start(const ReceiverView& view, const Vec3& direction);

/// Calls visit(k, w · light) for a receiver's values of one kind: irradiance by channel, or radiance by gloss; light by
/// channel, w by colour.
template <class Visit>
void over_reflected(std::size_t values, const std::array<double, 3>& weight, const std::vector<double>& light,
                    const Visit& visit) {
  for (std::size_t k = 0; k < values; ++k) visit(k, weight[k % 3] * light[light.size() == 1 ? 0 : k]);
}

}  // namespace lumifield
