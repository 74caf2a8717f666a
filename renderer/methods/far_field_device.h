#pragma once

#include "renderer/methods/sampled_device.h"

namespace lumifield {

/// The kernel of far-field: one look-up in a table for each receiver. Thread-bound.
class FarFieldDevice final : public SampledDevice {
 public:
  static Result<std::unique_ptr<FarFieldDevice>> create(const LuminaireGeometry& geometry,
                                                        const MethodSettings& settings);
  Status set_cells(const LightField& light_field) override;

 private:
  using SampledDevice::SampledDevice;
  void set_arguments(DeviceKernel& kernel) override;
  Status make_points() override { return {}; }

  DeviceBuffer table_;
};

}  // namespace lumifield
