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

std::vector<SampledCell> sampled_cells(const LightField& light_field,
                                       std::vector<double> (*importance)(const CellImage&)) {
  std::vector<SampledCell> cells;
  const Sampling& sampling = light_field.geometry().sampling;
  for (int flat = 0; flat < sampling.cells(); ++flat) {
    const CellIndex index = sampling.index(flat);
    auto image = light_field.cell(index);
    if (!image) continue;
    SummedAreaTable table(importance(*image), image->width_px, image->height_px);
    cells.push_back(
        {sampling.cell_center_mm(index), static_cast<std::uint32_t>(flat), std::move(image), std::move(table)});
  }
  return cells;
}

}  // namespace lumifield
