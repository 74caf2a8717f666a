#include "renderer/methods/light_tables.h"

#include "renderer/sampling/sequence.h"

namespace lumifield {

/// Rows of W + 1 and columns of H + 1 sums.
LightTables::LightTables(const Measurement& measurement, std::size_t stride)
    : width_(static_cast<std::size_t>(measurement.width_px)),
      height_(static_cast<std::size_t>(measurement.height_px)),
      stride_(stride),
      column_stride_(padded(height_)),
      table_(stride * (height_ + 1)),
      columns_(column_stride_ * width_) {}

bool LightTables::fits() const { return table_ < std::size_t(1) << 31 && columns_ < std::size_t(1) << 31; }

void LightTables::describe(SamplingGeometry& shared) const {
  shared.stride = static_cast<int>(stride_);
  shared.column_stride = static_cast<int>(column_stride_);
  shared.table = static_cast<int>(table_);
  shared.columns = static_cast<int>(columns_);
}

Status LightTables::make_room(OpenClDevice& device, std::size_t cells) {
  if (Status room = device.make_room(on_device_, cells * table_ * sizeof(double), "summed-area tables"); !room)
    return room;
  return device.make_room(columns_on_device_, cells * columns_ * sizeof(double), "column sums");
}

Status LightTables::upload(OpenClDevice& device, std::size_t m, const SummedAreaTable& importance) {
  const auto write = [&](const DeviceBuffer& buffer, const std::vector<double>& values) {
    return device.write(buffer, m * values.size() * sizeof(double), std::as_bytes(std::span(values)));
  };
  std::vector<double> table(table_, 0.0);
  for (std::size_t j = 0; j <= height_; ++j)
    for (std::size_t i = 0; i <= width_; ++i)
      table[j * stride_ + i] = importance.corner(static_cast<int>(i), static_cast<int>(j));
  if (Status done = write(on_device_, table); !done) return done;
  std::vector<double> columns(columns_, 0.0);
  for (std::size_t i = 0; i < width_; ++i) {
    double* sum = columns.data() + i * column_stride_;
    for (std::size_t j = 0; j < height_; ++j)
      sum[j + 1] = sum[j] + importance.value(static_cast<int>(i), static_cast<int>(j));
  }
  return write(columns_on_device_, columns);
}

std::vector<SamplingCell> sampling_cells(const Sampling& sampling, std::span<const int> numbers, std::uint32_t seed,
                                         bool together) {
  std::vector<SamplingCell> cells;
  for (const int number : numbers) {
    const Vec2 u = sampling.cell_center_mm(sampling.index(number));
    const UnitPoint shift = cell_shift(seed, together ? 0 : static_cast<std::uint32_t>(number));
    cells.push_back({u.x(), u.y(), shift.x, shift.y, number, 0});
  }
  return cells;
}

}  // namespace lumifield
