#pragma once

#include "renderer/methods/light_tables.h"
#include "renderer/methods/mis.h"
#include "renderer/methods/mis_shared.h"
#include "renderer/methods/ray_images.h"
#include "renderer/methods/sampled_device.h"

namespace lumifield {

/// Light samples weighed against lobe samples (Mis) as a kernel. Thread-bound.
class MisDevice final : public SampledDevice {
 public:
  static Result<std::unique_ptr<MisDevice>> create(const LuminaireGeometry& geometry, const MethodSettings& settings);

 private:
  MisDevice(const LuminaireGeometry& geometry, const MethodSettings& settings)
      : SampledDevice(geometry, settings), images_(geometry, settings.filter) {}
  Status take_cells(const LightField& light_field) override;
  unsigned set_arguments(DeviceKernel& kernel) override;
  Status make_points() override;
  double rays_of_a_receiver() const override;
  double further_bytes(std::size_t cells) const;

  RayImages images_;
  LightTables tables_;
  DeviceBuffer cells_, points_, diffuse_, glossy_;
  std::vector<int> numbers_;  ///< of the cells in the grid
  MisShares shares_{};
};

}  // namespace lumifield
