#pragma once

#include "renderer/methods/light_tables.h"
#include "renderer/methods/sampled_device.h"

namespace lumifield {

/// Parts of the position-dependent kernel, to see what each takes: the balance alone, and the draws, and their weights.
enum class SamplingSteps { balance = 1, draws = 2, all = 3 };

/// The methods that sample cells' images for each receiver: position-dependent, as printed, uniform-box. Images,
/// summed-area tables and column sums (doubles) lie on the device. Thread-bound.
class ImageSamplerDevice final : public SampledDevice {
 public:
  /// plain: the position-dependent kernel with scalar searches through its tables, as a yardstick; the same draws.
  static Result<std::unique_ptr<ImageSamplerDevice>> create(const LuminaireGeometry& geometry,
                                                            const MethodSettings& settings,
                                                            SamplingSteps steps = SamplingSteps::all,
                                                            bool plain = false);

 private:
  using SampledDevice::SampledDevice;
  Status take_cells(const LightField& light_field) override;
  unsigned set_arguments(DeviceKernel& kernel) override;
  Status make_points() override;
  Status check_receiver(const Receiver& receiver) const override;
  /// Of all cells together, bounded before any is taken.
  Status make_room(std::size_t cells);
  Status upload_image(std::size_t m, const CellImage& cell);
  Status upload_tables(std::size_t m, const SummedAreaTable& importance);

  LightTables tables_;
  DeviceBuffer cells_, images_, marginals_, points_;
  std::vector<int> numbers_;  ///< of the cells in the grid
};

}  // namespace lumifield
