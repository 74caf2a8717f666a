#pragma once

#include <memory>
#include <vector>

#include "luminaire/light_field.h"
#include "renderer/sampling/summed_area_table.h"

namespace lumifield {

/// A measured cell as methods that sample know it. Value type.
struct MeasuredCell {
  Vec2 u_mm;
  std::uint32_t number;  ///< Sampling::flat
  std::shared_ptr<const CellImage> image;
};

/// With what its samples are drawn by: 16 bytes a pixel beside the image.
struct SampledCell : MeasuredCell {
  SummedAreaTable importance;
};

/// C of a pixel, by channel.
inline auto of_pixel(const MeasuredCell& cell, int i, int j) {
  return [image = cell.image.get(), i, j](std::size_t c) {
    return static_cast<double>(image->at(static_cast<int>(c), i, j));
  };
}

/// What samples are drawn by: Σ_channels |C|, which no channel outgrows and no sign hides.
double importance_at(const CellImage& image, int i, int j);
std::vector<double> importance_image(const CellImage& image);
/// As published: the luminance, Y or 0.2126 R + 0.7152 G + 0.0722 B.
std::vector<double> luminance_image(const CellImage& image);

/// All measured cells in the grid's order.
std::vector<MeasuredCell> measured_cells(const LightField& light_field);
SummedAreaTable summed_area_table(const MeasuredCell& cell, std::vector<double> (*importance)(const CellImage&));
std::vector<SampledCell> sampled_cells(const LightField& light_field,
                                       std::vector<double> (*importance)(const CellImage&) = importance_image);

}  // namespace lumifield
