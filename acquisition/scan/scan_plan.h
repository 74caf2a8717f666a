#pragma once

#include <set>
#include <variant>
#include <vector>

#include "luminaire/bench.h"
#include "luminaire/error.h"
#include "luminaire/plan.h"
#include "luminaire/raw_image.h"

namespace lumifield {

/// The scan, step by step: a plan laid on a bench, checked against the bench's limits and geometry before anything moves.
/// Value type.
struct DarkStep {
  Vec2 stage_mm;
  int block;
};
struct ReferenceStep {
  Vec2 stage_mm;
  int cells_done;
};
struct CellStep {
  CellIndex cell;
  std::vector<int> pass_order;  ///< indices into bench.filter.passes, alternating so that the long move is made once a cell
  std::vector<Vec2> stage_mm;   ///< target per pass of `pass_order`
};
using ScanStep = std::variant<DarkStep, ReferenceStep, CellStep>;

struct ScanPlan {
  std::vector<ScanStep> steps;  ///< dark and reference first, reference last
  int cells = 0;
  double predicted_s = 0;  ///< from the stage's speed and acceleration, settle, exposure and readout times
};

/// Stage reading that puts the first pass' filter centre on u (mm on U).
Vec2 stage_target_mm(const Bench& bench, const Vec2& u_mm);

/// Lamp displacement in the bench frame at a stage reading: linear·q + origin when the stage carries the lamp, else 0.
Vec2 lamp_displacement_mm(const Bench& bench, const Vec2& stage_mm);

/// Refuses, with the number needed: a target outside the limits; filters closer than half the grid + half the lamp + half
/// the dual window (another filter would stand before the lamp); a grid smaller than lamp + window; a filter spacing that
/// is not the basis'; a reference cell outside the grid. Cells in `done` are left out.
Result<ScanPlan> make_scan_plan(const Bench& bench, const Plan& plan, const std::set<CellIndex>& done = {});

}  // namespace lumifield
