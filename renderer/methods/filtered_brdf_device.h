#pragma once

#include "renderer/methods/ray_images.h"
#include "renderer/methods/sampled_device.h"

namespace lumifield {

/// Samples of what receivers reflect (FilteredBrdf) as a kernel. Thread-bound.
class FilteredBrdfDevice final : public SampledDevice {
 public:
  static Result<std::unique_ptr<FilteredBrdfDevice>> create(const LuminaireGeometry& geometry,
                                                            const MethodSettings& settings);

 private:
  FilteredBrdfDevice(const LuminaireGeometry& geometry, const MethodSettings& settings)
      : SampledDevice(geometry, settings), images_(geometry, settings.filter) {}
  Status take_cells(const LightField& light_field) override;
  unsigned set_arguments(DeviceKernel& kernel) override;
  Status make_points() override;
  double rays_of_a_receiver() const override;

  RayImages images_;
  DeviceBuffer diffuse_, glossy_;
  std::size_t points_ = 0;  ///< in the table of each
};

}  // namespace lumifield
