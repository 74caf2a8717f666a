#pragma once

#include <algorithm>

#include "acquisition/cameras/pixel_layout.h"
#include "acquisition/scan/exposure_ladder.h"
#include "acquisition/scan/lamp_stability.h"
#include "acquisition/scan/scan_plan.h"
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

/// Frames that a scan exposes at most; what has to be taken again comes on top.
inline double exposed_frames(const Plan& plan, const ScanPlan& steps) {
  const double bracket = static_cast<double>(plan.exposures_s.size());
  const double ladder = static_cast<double>(exposure_ladder(plan).size());
  double frames = 0, slides = 0;
  for (const ScanStep& step : steps.steps) {
    if (std::holds_alternative<DarkStep>(step)) frames += ladder;
    if (std::holds_alternative<ReferenceStep>(step)) frames += bracket;
    if (std::holds_alternative<SlideStep>(step)) ++slides;
    if (const auto* cell = std::get_if<CellStep>(&step)) frames += ladder * static_cast<double>(cell->stage_mm.size());
  }
  // The lamp is watched before the first cell through each slide.
  if (plan.stabilisation) frames += bracket * most_readings(*plan.stabilisation) * std::max(1.0, slides);
  return frames;
}

/// What these frames take as a folder of frames (acquisition/cameras/frame_folder.h), at most.
inline double recorded_bytes(const Bench& bench, const Plan& plan, const ScanPlan& steps) {
  // The header, the frame's line in the list, and what the last block of 4 KiB leaves over.
  constexpr double beside_pixels = 4096 + 256;
  const auto layout = pixel_layout(bench.camera.pixel_format);
  const double pixel_bytes = layout && layout->bits <= 8 ? 1 : 2;
  const double pixels = static_cast<double>(bench.camera_model.width_px) * bench.camera_model.height_px;
  return exposed_frames(plan, steps) * (pixels * pixel_bytes + beside_pixels);
}

}  // namespace lumifield
