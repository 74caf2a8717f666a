#pragma once

#include <algorithm>

#include "acquisition/scan/exposure_ladder.h"
#include "calibration/develop.h"
#include "luminaire/light_field.h"

namespace lumifield {

/// What a stored cell takes on disk at most: values and variance in FLOAT. Real ones compress to a half or less.
inline double stored_cell_bytes(const LuminaireGeometry& geometry) {
  return static_cast<double>(geometry.measurement.pixels()) * static_cast<double>(geometry.channels.size()) * 2 *
         sizeof(float);
}

/// What is kept besides, until the scan has ended, where the operator changes the slide: raw frames of all passes but
/// the last of `cells`, and of their dark sets. Else 0.
inline double half_cells_bytes(const Bench& bench, const Plan& plan, int cells) {
  if (bench.filter.change == PassChange::stage) return 0;
  const int every = plan.dark_every_cells;
  const int dark_sets = every > 0 ? (cells + every - 1) / every : std::min(cells, 1);
  const double brackets = static_cast<double>(bench.filter.passes.size() - 1) * (cells + dark_sets);
  return brackets * static_cast<double>(exposure_ladder(plan).size()) * bench.camera_model.width_px *
         bench.camera_model.height_px * sizeof(std::uint16_t);
}

/// What a scan of so many cells takes at most.
inline double stored_bytes(const Bench& bench, const Plan& plan, int cells) {
  return cells * stored_cell_bytes(luminaire_geometry(bench, plan)) + half_cells_bytes(bench, plan, cells);
}

}  // namespace lumifield
