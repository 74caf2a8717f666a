#pragma once

#include <array>
#include <span>
#include <vector>

#include "renderer/methods/host_method.h"
#include "renderer/methods/sampled_cell.h"

namespace lumifield {

/// A light sample: a point of one cell's image that stands for its share of the luminaire.
struct PrecomputedLight {
  int cell;                     ///< into the cells
  Vec2 on_s_px;                 ///< in pixels from the image's corner
  std::array<double, 3> value;  ///< per channel, the rest 0: C/importance · T/K, C-units · pixel²
};

/// K lights shared out among the cells by T_m = ∫ importance_m (systematic rounding) and drawn from each cell's whole
/// image (PiecewiseConstant2D): independent of any receiver. T = Σ T_m. Tables are made for one cell at a time.
std::vector<PrecomputedLight> precompute_lights(std::span<const MeasuredCell> cells, const MethodSettings& settings);

/// The baseline of Lu 2015 Fig. 11: every receiver is lit by the same K lights, of which it sees those whose ray passes
/// through their cell's support. Unbiased over seeds; the nearer to S, the fewer lights are seen: refused on S, where
/// none is.
class PrecomputedLights final : public HostMethod {
 public:
  PrecomputedLights(const LightField& light_field, const MethodSettings& settings);

  using HostMethod::estimate;
  Result<std::vector<double>> light(const Receiver& receiver, std::uint32_t number, const Look& look) const override;
  Result<Estimate> estimate(const Receiver& receiver, std::uint32_t number, const Look& look) const override;

 private:
  LuminaireGeometry geometry_;
  Basis basis_;
  MethodSettings settings_;
  std::vector<MeasuredCell> cells_;
  double total_ = 0;  ///< T
  std::vector<PrecomputedLight> lights_;
};

}  // namespace lumifield
