#include "renderer/methods/sampled_cell.h"

#include <cmath>

namespace lumifield {

double importance_at(const CellImage& image, int i, int j) {
  double sum = 0;
  for (int c = 0; c < image.channels; ++c) sum += std::abs(static_cast<double>(image.at(c, i, j)));
  return sum;
}

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

std::vector<MeasuredCell> measured_cells(const LightField& light_field) {
  const Sampling& sampling = light_field.geometry().sampling;
  std::vector<MeasuredCell> cells;
  for (int flat = 0; flat < sampling.cells(); ++flat) {
    const CellIndex index = sampling.index(flat);
    if (auto image = light_field.cell(index))
      cells.push_back({sampling.cell_center_mm(index), static_cast<std::uint32_t>(flat), std::move(image)});
  }
  return cells;
}

SummedAreaTable summed_area_table(const MeasuredCell& cell, std::vector<double> (*importance)(const CellImage&)) {
  return SummedAreaTable(importance(*cell.image), cell.image->width_px, cell.image->height_px);
}

std::vector<SampledCell> sampled_cells(const LightField& light_field,
                                       std::vector<double> (*importance)(const CellImage&)) {
  std::vector<SampledCell> cells;
  for (const MeasuredCell& cell : measured_cells(light_field))
    cells.push_back({cell, summed_area_table(cell, importance)});
  return cells;
}

}  // namespace lumifield
