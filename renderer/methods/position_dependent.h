#pragma once

#include <vector>

#include "renderer/methods/host_method.h"
#include "renderer/methods/light_samples.h"

namespace lumifield {

/// Position-dependent importance sampling (Lu, Pacanowski, Granier 2015) with what the print gets wrong put right.
///
/// Each receiver sees a box of each cell's image; K samples are shared out among the cells by A_m, the box' integral of
/// the importance Σ_channels |C_m|, and drawn in the box by density importance/A_m (BoxDistribution). With A in units
/// of τ² (ReceiverView) and F the weight there,
///
///     E ≈ Σ_m A_m/κ_m Σ_{k ≤ K_m} F_m(τ_k) C_m(s_k)/importance_m(s_k),   κ_m = min(K A_m/A, K_max)
///
/// K_m is the systematic rounding of κ_m, and κ_m, not K_m, divides: unbiased at any K. Every cell has its own rotation
/// of one point sequence, which all receivers share. Where a support spans fewer than 4 pixels samples are uniform on
/// U; A_m is then the mean over the pixels touched times the support, since table corners lose their digits.
class PositionDependent final : public HostMethod {
 public:
  PositionDependent(const LightField& light_field, const MethodSettings& settings);

  using HostMethod::estimate;
  Result<std::vector<double>> light(const Receiver& receiver, std::uint32_t number, const Look& look) const override;
  Result<Estimate> estimate(const Receiver& receiver, std::uint32_t number, const Look& look) const override;

 private:
  LuminaireGeometry geometry_;
  Basis basis_;
  MethodSettings settings_;
  LightSamples lights_;
};

/// Adds scale · F C/importance of one sample.
void add_sample(const ReceiverView& view, const SampledCell& cell, const Vec2& tau, int i, int j, double scale,
                std::vector<double>& sum);

}  // namespace lumifield
