#pragma once

#include <cmath>
#include <memory>
#include <vector>

#include "app/views/luminaire_model.h"

namespace lumifield {

/// A luminaire of small images for the tests of what shows cells.
inline LuminaireGeometry lamp_geometry(int columns, int rows, std::vector<std::string> channels = {"Y"}) {
  LuminaireGeometry geometry;
  geometry.planes.separation_mm = 150;
  geometry.sampling = {BasisKind::bell, {7.5, 7.5}, columns, rows, {0, 0}};
  geometry.measurement = {8, 6, {0.5, 0.5}, {10, 0}};
  geometry.channels = std::move(channels);
  geometry.quantity = Quantity::luminance;
  return geometry;
}

/// Every value of channel c is `value · (c + 1)`.
inline std::shared_ptr<CellImage> flat_image(const LuminaireGeometry& geometry, float value) {
  const Measurement& m = geometry.measurement;
  CellImage image{m.width_px, m.height_px, static_cast<int>(geometry.channels.size()), {}, {}, {}};
  for (int c = 0; c < image.channels; ++c)
    image.value.insert(image.value.end(), m.pixels(), value * static_cast<float>(c + 1));
  return std::make_shared<CellImage>(std::move(image));
}

inline CellEntry entry_of(CellIndex cell, const Quality& quality = {}) { return {cell, "a.exr", 1, "", {}, quality}; }

inline Quality warned() {
  Quality quality;
  quality.saturated_share = 0.25;
  quality.median_snr = std::nan("");
  quality.warnings = {"saturated share 25 % above 0.1 %"};
  return quality;
}

}  // namespace lumifield
