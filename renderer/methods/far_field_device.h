#pragma once

#include "renderer/methods/sampled_device.h"

namespace lumifield {

/// The kernel of far-field: one look-up in a table for each receiver. Thread-bound.
class FarFieldDevice final : public SampledDevice {
 public:
  static Result<std::unique_ptr<FarFieldDevice>> create(const LuminaireGeometry& geometry,
                                                        const MethodSettings& settings);

 private:
  using SampledDevice::SampledDevice;
  Status take_cells(const LightField& light_field) override;
  unsigned set_arguments(DeviceKernel& kernel) override;
  Status make_points() override { return {}; }

  DeviceBuffer table_;
};

}  // namespace lumifield
