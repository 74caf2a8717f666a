#pragma once

#include <vector>

#include "renderer/methods/host_method.h"
#include "renderer/methods/sampled_cell.h"
#include "renderer/sampling/sequence.h"

namespace lumifield {

/// The baseline of Lu 2015 Fig. 12: as many samples for each measured cell, uniform over its support, which is uniform
/// over the box on S and needs no table. κ_m = K/M, rounded systematically; unbiased.
class UniformBox final : public HostMethod {
 public:
  UniformBox(const LightField& light_field, const MethodSettings& settings);

  using HostMethod::estimate;
  Result<std::vector<double>> light(const Receiver& receiver, std::uint32_t number, const Look& look) const override;
  Result<Estimate> estimate(const Receiver& receiver, std::uint32_t number, const Look& look) const override;

 private:
  LuminaireGeometry geometry_;
  Basis basis_;
  MethodSettings settings_;
  std::vector<MeasuredCell> cells_;
  PointSet points_;
};

}  // namespace lumifield
