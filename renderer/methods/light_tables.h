#pragma once

#include <span>
#include <vector>

#include "luminaire/light_field.h"
#include "renderer/methods/sampling_shared.h"
#include "renderer/opencl/device.h"
#include "renderer/sampling/summed_area_table.h"

namespace lumifield {

/// What light_draws.clh draws by, on the device: each cell's summed-area table, whose rows lie as its image's do, and
/// the sums of its columns; all in double. Thread-bound.
class LightTables {
 public:
  LightTables() = default;
  /// stride: floats from row to row of an image, padded(width) at least.
  LightTables(const Measurement& measurement, std::size_t stride);

  /// Numbers that a kernel reads at once; rows are padded so that it stays within the table.
  static std::size_t padded(std::size_t n) {
    constexpr std::size_t vector_width = 16;
    return (n + 2 * vector_width - 1) / vector_width * vector_width;
  }
  /// The kernel counts a cell's numbers in int.
  bool fits() const;
  void describe(SamplingGeometry& shared) const;
  std::size_t cell_bytes() const { return (table_ + columns_) * sizeof(double); }

  Status make_room(OpenClDevice& device, std::size_t cells);
  /// Of cell m.
  Status upload(OpenClDevice& device, std::size_t m, const SummedAreaTable& importance);
  const DeviceBuffer& tables() const { return on_device_; }
  const DeviceBuffer& columns() const { return columns_on_device_; }

 private:
  std::size_t width_ = 0, height_ = 0, stride_ = 0, column_stride_ = 0;
  std::size_t table_ = 0, columns_ = 0;  ///< doubles of a cell
  DeviceBuffer on_device_, columns_on_device_;
};

/// The kernels' cells, of these numbers in the grid, each with its rotation of the sequence; `together`: one for all.
std::vector<SamplingCell> sampling_cells(const Sampling& sampling, std::span<const int> numbers, std::uint32_t seed,
                                         bool together = false);

}  // namespace lumifield
