#pragma once

#include <set>
#include <string>
#include <variant>
#include <vector>

#include "luminaire/bench.h"
#include "luminaire/error.h"
#include "luminaire/plan.h"
#include "luminaire/raw_image.h"

namespace lumifield {

/// The scan, step by step: a plan laid on a bench, checked against the bench's limits and geometry before anything
/// moves. Value type.
struct DarkStep {
  Vec2 stage_mm;
  int block;
};
struct ReferenceStep {
  Vec2 stage_mm;   ///< of the first pass; of the one that is taken, where the operator changes it
  int cells_done;  ///< of this plan
};
struct CellStep {
  CellIndex cell;
  std::vector<int> pass_order;  ///< indices into bench.filter.passes, forwards or backwards, whichever starts nearer:
                                ///< the long move between filters is made once a cell. One, where the operator
                                ///< changes the pass
  std::vector<Vec2> stage_mm;   ///< target per pass of `pass_order`
};
/// Where the stage only goes to.
struct VisitStep {
  Vec2 stage_mm;
  std::string place;  ///< "corner cell (0, 8), pass negative"
};
/// Where the operator changes the pass (PassChange::by_operator): from here on this one stands before the lamp.
struct SlideStep {
  Vec2 stage_mm;  ///< where the stage waits for it: behind the opaque patch
  int pass;
  int cells_before;  ///< whose pass was taken before this scan
};
using ScanStep = std::variant<DarkStep, ReferenceStep, CellStep, VisitStep, SlideStep>;

struct ScanPlan {
  /// Dark and reference first, reference last; empty when all cells are done. Where the operator changes the pass, so
  /// for each pass that has cells left, one after the other, its slide before.
  std::vector<ScanStep> steps;
  int cells = 0;         ///< to be scanned
  int cells_before = 0;  ///< of the grid, left out as done before
  double predicted_s =
      0;  ///< from the stage's speed and acceleration, settle, readout and the plan's exposure times. Speeds of 0
          ///< in the bench file count as 10 mm/s and 50 mm/s²: fill in what the controller reports first
};

/// Stage reading that puts the first pass' filter centre on u (mm on U). bench.stage_to_luminaire.linear is invertible.
Vec2 stage_target_mm(const Bench& bench, const Vec2& u_mm);

/// Stage reading that centres the opaque patch on the lamp, which is centred on u = 0. The stage is parked there too.
Vec2 dark_target_mm(const Bench& bench);

/// Stage reading of the reference cell in that pass.
Vec2 reference_target_mm(const Bench& bench, const Plan& plan, int pass = 0);

/// The step that takes one cell, its passes in the order that is nearer to `from_mm` (a stage reading); where the
/// operator changes the pass, `pass` alone.
CellStep make_cell_step(const Bench& bench, const Plan& plan, CellIndex cell, const Vec2& from_mm, int pass = 0);

/// Cells by pass.
using PassCells = std::vector<std::set<CellIndex>>;

/// Refuses, with the number needed: a target outside the limits; filters or opaque patch closer than half the grid +
/// half the lamp + half the dual window (another filter would stand before the lamp; filters of different slides may
/// stand anywhere); a grid without some cell whose dual window touches the lamp; scales that are not the dual's within
/// 1 %; a reference cell outside the grid; exposures outside (0, 10 s] or not ascending, exposure limits outside or
/// that do not hold them; a singular stage frame. Cells in `done` are left out, those in `taken[p]` out of pass p where
/// the operator changes it.
Result<ScanPlan> make_scan_plan(const Bench& bench, const Plan& plan, const std::set<CellIndex>& done = {},
                                const PassCells& taken = {});

/// What tells before a scan whether it will go through: a dark set, the grid's corners in every pass, the reference
/// cell, and the cell `shot`, of which the first pass alone where the operator changes it. Refuses what make_scan_plan
/// does, and a cell beside the grid.
Result<ScanPlan> make_rehearsal(const Bench& bench, const Plan& plan, CellIndex shot);

}  // namespace lumifield
