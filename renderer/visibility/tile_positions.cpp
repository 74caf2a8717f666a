#include "renderer/visibility/tile_positions.h"

#include <algorithm>

#include "renderer/methods/sampled_cell.h"
#include "renderer/sampling/piecewise_constant_1d.h"

namespace lumifield {

std::optional<Vec2> median_mm(const Measurement& measurement, const CellImage& image) {
  const std::vector<double> importance = importance_image(image);
  const auto width = static_cast<std::size_t>(image.width_px), height = static_cast<std::size_t>(image.height_px);
  std::vector<double> columns(width, 0.0), column(height);
  for (std::size_t k = 0; k < importance.size(); ++k) columns[k % width] += importance[k];
  const auto x = PiecewiseConstant1D(columns).sample(0.5, 0, static_cast<double>(width));
  if (!x) return std::nullopt;
  const auto i = static_cast<std::size_t>(std::clamp(*x, 0.0, static_cast<double>(width - 1)));
  for (std::size_t j = 0; j < height; ++j) column[j] = importance[j * width + i];
  const auto y = PiecewiseConstant1D(column).sample(0.5, 0, static_cast<double>(height));
  if (!y) return std::nullopt;
  return measurement.corner_mm() + measurement.pixel_mm.cwiseProduct(Vec2(*x, *y));
}

TilePositions published_positions(const LightField& light_field) {
  const Sampling& sampling = light_field.geometry().sampling;
  TilePositions positions{TileGrid(sampling), {}};
  const TileGrid& grid = positions.grid;
  std::vector<Vec2> sum(static_cast<std::size_t>(grid.tiles()), Vec2(0, 0));
  std::vector<int> cells(sum.size(), 0);
  for (const MeasuredCell& cell : measured_cells(light_field)) {
    const auto median = median_mm(light_field.geometry().measurement, *cell.image);
    if (!median) continue;
    const CellIndex at = sampling.index(static_cast<int>(cell.number));
    for (int k = 0; k < grid.per_support; ++k)
      for (int i = 0; i < grid.per_support; ++i) {
        const auto tile = static_cast<std::size_t>((at.row + k) * grid.columns + at.column + i);
        sum[tile] += *median;
        ++cells[tile];
      }
  }
  positions.on_s_mm.resize(sum.size());
  for (std::size_t k = 0; k < sum.size(); ++k)
    if (cells[k] > 0) positions.on_s_mm[k] = sum[k] / cells[k];
  return positions;
}

void add_missing(TilePositions& positions, const TilePositions& others) {
  for (std::size_t k = 0; k < positions.on_s_mm.size(); ++k)
    if (!positions.on_s_mm[k]) positions.on_s_mm[k] = others.on_s_mm[k];
}

}  // namespace lumifield
