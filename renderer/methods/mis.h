#pragma once

#include <array>
#include <optional>
#include <vector>

#include "renderer/methods/host_method.h"
#include "renderer/methods/light_samples.h"
#include "renderer/methods/lobe_sampling.h"
#include "renderer/methods/ray_light.h"

namespace lumifield {

/// Samples of a receiver by K: K_L of the light, or `light_beside` those of a glossy lobe, or `light_apart` from them;
/// N of its diffuse lobe, or of the glossy one.
struct MisCounts {
  double light, light_beside, light_apart;
  int diffuse, glossy;
};
/// K; K/2, 7/8 K; K/2; 4 K.
MisCounts mis_counts(double samples);

/// Multiple importance sampling (Veach, Guibas 1995) of PositionDependent's light samples with FilteredBrdf's lobe
/// samples, by the balance heuristic.
///
/// Both are rays ω that leave U at u(ω) and show s(u) of S, and each cell's light C_m Φ_m is estimated from its own
/// light samples and from all lobe samples, whose rays see every cell that they meet. With κ_m/A_m = K_L/A, the same
/// for all cells, and du = |u−p|²/cosθ dω, there are per steradian
///
///     q_m(ω) = |u−p|²/cosθ · K_L/(A a_x a_y) · importance_m(s) [u in the support of Φ_m]
///
/// expected light samples of cell m (near S the mean over the pixels touched in place of importance_m(s):
/// LightSamples), and b(ω) = N pdf(ω) lobe samples. Then, F_m = C_m Φ_m δ²/cos⁴θ n·ω, or f n·ω for gloss,
///
///     E ≈ Σ_m Σ_{k ≤ K_m} F_m/(q_m + b)(ω_mk) + Σ_{k ≤ N} Σ_m F_m/(q_m + b)(ω_k)
///
/// unbiased at any K. A light sample costs what PositionDependent's does, and where b = 0 is one, with its regularity:
/// weighed by all cells that could have drawn u (MATHS.md § 3) it would be less noisy, but dearer, and keep less of the
/// Halton sequence's regularity: in equal time better for some samples a cell, worse for more.
///
/// Which lobe is sampled, and how many rays of either kind there are, follows from the receiver's geometry alone, so
/// that no pilot biases it: K_L = K where lobes show little of the lamp (mis_shared.h), since there light samples are
/// the better of the two for gloss too, and lobe samples time lost; of a glossy lobe that shows it N = 4 K beside K/2,
/// since there its light outshines what is diffuse and lobe samples are far better; else of the diffuse one K/2, which
/// is near the lamp. (Diffuse lobe samples beside glossy ones as a third kind: 0.87 to 1.09 of the error in equal time,
/// so not kept. N = K beside K for lobes that show somewhat less of it: up to 1.5 of the better part's, so not kept.)
///
/// Filtered, a glossy lobe's samples stand for the footprint of Ω = 1/b and look up the average L̄ (RayLight). A weight
/// that changed within a footprint would count what is averaged twice, or not at all: q_m is then, in the weights of
/// both kinds, the light's density as if even over the lamp's part of U, averaged over the footprint too, and an eighth
/// of it, since an average is worth more than a ray. The bias is the filter's alone, and less than FilteredBrdf's.
/// Of a lobe that is narrower still (MIS_SPLITS) averages err so little that light samples of its gloss only add noise,
/// and so do its rays to what is diffuse: each kind then makes one of the two by itself, and nothing is weighed.
class Mis final : public HostMethod {
 public:
  /// counts: other lobe samples than mis_counts gives.
  Mis(const LightField& light_field, const MethodSettings& settings, std::optional<MisCounts> counts = std::nullopt);

  using HostMethod::estimate;
  Result<std::vector<double>> light(const Receiver& receiver, std::uint32_t number, const Look& look) const override;
  /// The deviation of independent samples, as their variances add up, and of filtered ones the distance of their mean
  /// from ∫ L f n·ω dω, from 16 N and more points of the same density.
  Result<Estimate> estimate(const Receiver& receiver, std::uint32_t number, const Look& look) const override;

  /// What a receiver's samples of cell C Φ at u on U are weighed by, of each kind, for its last value; 0 where no light
  /// is seen.
  struct Weights {
    double light, lobes;
  };
  Weights weights(const Receiver& receiver, const Look& look, CellIndex cell, const Vec2& u_mm) const;

 private:
  class Mixture;
  struct Moments;
  const SampledCell& cell(std::uint32_t number) const { return lights_.cells()[by_number_[number]]; }
  void add_light_samples(const Mixture& mix, std::uint32_t number, std::vector<double>& values) const;
  void add_lobe_samples(const Mixture& mix, std::uint32_t number, std::vector<double>& values) const;
  void add_filtered_lobes(const Mixture& mix, Moments& sums) const;
  std::vector<double> stated(const Mixture& mix) const;

  MethodSettings settings_;
  MisCounts counts_;
  RayLight rays_;
  LightSamples lights_;
  std::vector<std::size_t> by_number_;  ///< of a measured cell of the grid its place in lights_
  std::vector<LobePoint> diffuse_, glossy_;
};

}  // namespace lumifield
