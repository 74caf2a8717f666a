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

namespace {

/// Of all tiles of a cell, by their number.
template <class Visit>
void over_tiles(const TileGrid& grid, CellIndex cell, const Visit& visit) {
  for (int row = cell.row; row < cell.row + grid.per_support; ++row)
    for (int column = cell.column; column < cell.column + grid.per_support; ++column)
      visit(static_cast<std::size_t>(row * grid.columns + column));
}

}  // namespace

FirstPositions::FirstPositions(const LuminaireGeometry& geometry)
    : sampling_(geometry.sampling),
      measurement_(geometry.measurement),
      positions_{TileGrid(geometry.sampling), {}},
      known_(static_cast<std::size_t>(sampling_.cells())) {
  positions_.on_s_mm.resize(static_cast<std::size_t>(positions_.grid.tiles()));
}

bool FirstPositions::lacks(CellIndex cell) const {
  bool some = false;
  over_tiles(positions_.grid, cell, [&](std::size_t tile) { some = some || !positions_.on_s_mm[tile]; });
  return some;
}

const std::optional<Vec2>& FirstPositions::median(int flat, const std::shared_ptr<const CellImage>& image) {
  Known& known = known_[static_cast<std::size_t>(flat)];
  if (known.image != image) {
    known = {image, median_mm(measurement_, *image)};
    ++medians_computed_;
  }
  return known.median;
}

bool FirstPositions::would_give(CellIndex cell, const std::shared_ptr<const CellImage>& image) {
  return lacks(cell) && median(sampling_.flat(cell), image).has_value();
}

void FirstPositions::take(std::span<const std::shared_ptr<const CellImage>> cells) {
  std::vector<Vec2> sum(positions_.on_s_mm.size(), Vec2(0, 0));
  std::vector<int> count(sum.size(), 0);
  for (int flat = 0; flat < sampling_.cells(); ++flat) {
    const auto& image = cells[static_cast<std::size_t>(flat)];
    const CellIndex cell = sampling_.index(flat);
    if (!image || !lacks(cell)) continue;
    const auto& at = median(flat, image);
    if (!at) continue;
    over_tiles(positions_.grid, cell, [&](std::size_t tile) {
      sum[tile] += *at;
      ++count[tile];
    });
  }
  for (std::size_t k = 0; k < sum.size(); ++k)
    if (!positions_.on_s_mm[k] && count[k] > 0) positions_.on_s_mm[k] = sum[k] / count[k];
  for (int flat = 0; flat < sampling_.cells(); ++flat)
    if (!lacks(sampling_.index(flat))) known_[static_cast<std::size_t>(flat)] = {};
}

std::vector<std::shared_ptr<const CellImage>> images_by_cell(const LightField& light_field) {
  const Sampling& sampling = light_field.geometry().sampling;
  std::vector<std::shared_ptr<const CellImage>> images;
  for (int flat = 0; flat < sampling.cells(); ++flat) images.push_back(light_field.cell(sampling.index(flat)));
  return images;
}

TilePositions published_positions(const LightField& light_field) {
  FirstPositions first(light_field.geometry());
  first.take(images_by_cell(light_field));
  return first.positions();
}

}  // namespace lumifield
