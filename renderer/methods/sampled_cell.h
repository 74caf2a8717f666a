#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "luminaire/light_field.h"
#include "renderer/sampling/summed_area_table.h"

namespace lumifield {

/// A measured cell as methods that sample know it. Value type.
struct SampledCell {
  Vec2 u_mm;
  std::uint32_t number;  ///< Sampling::flat
  std::shared_ptr<const CellImage> image;
  SummedAreaTable importance;
};

/// What samples are drawn by: Σ_channels |C|, which no channel outgrows and no sign hides.
std::vector<double> importance_image(const CellImage& image);
/// As published: the luminance, Y or 0.2126 R + 0.7152 G + 0.0722 B.
std::vector<double> luminance_image(const CellImage& image);

/// A cell of a light field; empty while it is unmeasured.
std::optional<SampledCell> sampled_cell(const LightField& light_field, int flat,
                                        std::vector<double> (*importance)(const CellImage&));
/// All measured cells in the grid's order.
std::vector<SampledCell> sampled_cells(const LightField& light_field,
                                       std::vector<double> (*importance)(const CellImage&) = importance_image);

}  // namespace lumifield
