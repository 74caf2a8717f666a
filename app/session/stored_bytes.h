#pragma once

#include "acquisition/scan/exposure_ladder.h"
#include "luminaire/light_field.h"

namespace lumifield {

/// What a stored cell takes on disk at most: values and variance in FLOAT. Real ones compress to a half or less.
inline double stored_cell_bytes(const LuminaireGeometry& geometry) {
  return static_cast<double>(geometry.measurement.pixels()) * static_cast<double>(geometry.channels.size()) * 2 *
         sizeof(float);
}

/// What a cell takes besides, until the scan has ended, where the operator changes the slide: raw frames of all passes
/// but the last. Else 0.
inline double half_cells_bytes(const Bench& bench, const Plan& plan) {
  if (bench.filter.change == PassChange::stage) return 0;
  const double frames = static_cast<double>((bench.filter.passes.size() - 1) * exposure_ladder(plan).size());
  return frames * bench.camera_model.width_px * bench.camera_model.height_px * sizeof(std::uint16_t);
}

}  // namespace lumifield
