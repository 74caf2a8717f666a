#include "renderer/methods/sampled_cell.h"

#include <cmath>

namespace lumifield {

std::vector<double> importance_image(const CellImage& image) {
  std::vector<double> sum(image.plane(), 0.0);
  for (int c = 0; c < image.channels; ++c)
    for (std::size_t k = 0; k < sum.size(); ++k) sum[k] += std::abs(static_cast<double>(image.channel(c)[k]));
  return sum;
}

std::vector<double> luminance_image(const CellImage& image) {
  std::vector<double> sum(image.plane(), 0.0);
  constexpr double rec709[] = {0.2126, 0.7152, 0.0722};
  for (int c = 0; c < image.channels; ++c)
    for (std::size_t k = 0; k < sum.size(); ++k)
      sum[k] += (image.channels == 1 ? 1 : rec709[c]) * static_cast<double>(image.channel(c)[k]);
  return sum;
}

std::optional<SampledCell> sampled_cell(const LightField& light_field, int flat,
                                        std::vector<double> (*importance)(const CellImage&)) {
  const Sampling& sampling = light_field.geometry().sampling;
  const CellIndex index = sampling.index(flat);
  auto image = light_field.cell(index);
  if (!image) return std::nullopt;
  SummedAreaTable table(importance(*image), image->width_px, image->height_px);
  return SampledCell{sampling.cell_center_mm(index), static_cast<std::uint32_t>(flat), std::move(image),
                     std::move(table)};
}

std::vector<SampledCell> sampled_cells(const LightField& light_field,
                                       std::vector<double> (*importance)(const CellImage&)) {
  std::vector<SampledCell> cells;
  for (int flat = 0; flat < light_field.geometry().sampling.cells(); ++flat)
    if (auto cell = sampled_cell(light_field, flat, importance)) cells.push_back(std::move(*cell));
  return cells;
}

}  // namespace lumifield
