#pragma once

#include "renderer/methods/sampled_device.h"

namespace lumifield {

/// The kernel of precomputed-lights. Where a light lies is held as two floats, good to 2^−48 of the image: a support
/// near S spans parts of a pixel that one float does not have. Thread-bound.
class PrecomputedLightsDevice final : public SampledDevice {
 public:
  static Result<std::unique_ptr<PrecomputedLightsDevice>> create(const LuminaireGeometry& geometry,
                                                                 const MethodSettings& settings);

 private:
  using SampledDevice::SampledDevice;
  Status take_cells(const LightField& light_field) override;
  unsigned set_arguments(DeviceKernel& kernel) override;
  Status make_points() override;
  Status check_memory() const;
  Status check_receiver(const Receiver& receiver) const override;

  std::vector<MeasuredCell> measured_;
  DeviceBuffer cells_, lights_;
};

}  // namespace lumifield
