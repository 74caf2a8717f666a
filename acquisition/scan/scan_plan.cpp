#include "acquisition/scan/scan_plan.h"

#include <Eigen/LU>
#include <algorithm>
#include <numeric>

#include "acquisition/scan/motion_time.h"
#include "acquisition/scan/scan_order.h"
#include "acquisition/scan/scan_rules.h"

namespace lumifield {

namespace {

/// Filter centres of every pass at a cell, nearest end first as seen from `from`.
CellStep cell_step(const Bench& bench, const Sampling& grid, CellIndex cell, const Vec2& from,
                   const StageSpeed& speed) {
  const std::vector<FilterPass>& passes = bench.filter.passes;
  const Vec2 first = stage_target_mm(bench, grid.cell_center_mm(cell));
  CellStep step{cell, std::vector<int>(passes.size()), {}};
  std::iota(step.pass_order.begin(), step.pass_order.end(), 0);
  if (move_time_s(speed, from, first + passes.back().offset_mm) <
      move_time_s(speed, from, first + passes.front().offset_mm))
    std::reverse(step.pass_order.begin(), step.pass_order.end());
  for (int pass : step.pass_order) step.stage_mm.push_back(first + passes[static_cast<std::size_t>(pass)].offset_mm);
  return step;
}

std::vector<ScanStep> make_steps(const Bench& bench, const Plan& plan, const std::vector<CellIndex>& cells) {
  const Sampling grid = sampling_of(bench, plan);
  const StageSpeed speed = stage_speed(bench.stage);
  const Vec2 dark = dark_target_mm(bench);
  const Vec2 reference = reference_target_mm(bench, plan);
  const auto due = [](int done, int every) { return done == 0 || (every > 0 && done % every == 0); };

  std::vector<ScanStep> steps;
  Vec2 at = dark;
  int blocks = 0;
  const int count = static_cast<int>(cells.size());
  for (int done = 0; done < count; ++done) {
    if (due(done, plan.dark_every_cells)) {
      steps.emplace_back(DarkStep{dark, blocks++});
      at = dark;
    }
    if (due(done, plan.reference.every)) {
      steps.emplace_back(ReferenceStep{reference, done});
      at = reference;
    }
    const CellStep step = cell_step(bench, grid, cells[static_cast<std::size_t>(done)], at, speed);
    at = step.stage_mm.back();
    steps.emplace_back(step);
  }
  if (count > 0) steps.emplace_back(ReferenceStep{reference, count});
  return steps;
}

}  // namespace

Vec2 stage_target_mm(const Bench& bench, const Vec2& u_mm) {
  const Vec2 image = bench.stage_carries == StageCarries::lamp ? Vec2(-u_mm) : u_mm;
  return bench.stage_to_luminaire.linear.inverse() * (image - bench.stage_to_luminaire.origin_mm);
}

Vec2 dark_target_mm(const Bench& bench) { return stage_target_mm(bench, Vec2(0, 0)) + bench.filter.dark_offset_mm; }

Vec2 reference_target_mm(const Bench& bench, const Plan& plan) {
  return stage_target_mm(bench, sampling_of(bench, plan).cell_center_mm(plan.reference.cell)) +
         bench.filter.passes.front().offset_mm;
}

CellStep make_cell_step(const Bench& bench, const Plan& plan, CellIndex cell, const Vec2& from_mm) {
  return cell_step(bench, sampling_of(bench, plan), cell, from_mm, stage_speed(bench.stage));
}

Result<ScanPlan> make_scan_plan(const Bench& bench, const Plan& plan, const std::set<CellIndex>& done) {
  if (Status status = check_rules(bench, plan); !status) return tl::unexpected(status.error());

  std::vector<CellIndex> cells = scan_order(plan.order, plan.columns, plan.rows);
  std::erase_if(cells, [&](CellIndex cell) { return done.contains(cell); });
  const int to_scan = static_cast<int>(cells.size());
  ScanPlan scan{make_steps(bench, plan, cells), to_scan, plan.columns * plan.rows - to_scan, 0};
  if (Status status = check_limits(bench, scan.steps); !status) return tl::unexpected(status.error());

  scan.predicted_s = scan_time_s(scan.steps, bench, plan, stage_speed(bench.stage));
  return scan;
}

Result<ScanPlan> make_rehearsal(const Bench& bench, const Plan& plan, CellIndex shot) {
  if (const auto whole = make_scan_plan(bench, plan); !whole) return tl::unexpected(whole.error());
  const Sampling grid = sampling_of(bench, plan);
  if (!grid.contains(shot))
    return fail("there is no cell " + to_string(shot) + " in a grid of " + std::to_string(plan.rows) + " rows and " +
                    std::to_string(plan.columns) + " columns",
                "test shot", "choose one of the grid's");
  ScanPlan scan{{DarkStep{dark_target_mm(bench), 0}}, 1, plan.columns * plan.rows - 1, 0};
  for (const FilterPass& pass : bench.filter.passes)
    for (const CellIndex corner : {CellIndex{0, 0}, CellIndex{0, plan.columns - 1},
                                   CellIndex{plan.rows - 1, plan.columns - 1}, CellIndex{plan.rows - 1, 0}})
      scan.steps.emplace_back(VisitStep{stage_target_mm(bench, grid.cell_center_mm(corner)) + pass.offset_mm,
                                        "corner cell " + to_string(corner) + ", pass " + pass.name});
  const Vec2 reference = reference_target_mm(bench, plan);
  scan.steps.emplace_back(ReferenceStep{reference, 0});
  scan.steps.emplace_back(make_cell_step(bench, plan, shot, reference));
  scan.predicted_s = scan_time_s(scan.steps, bench, plan, stage_speed(bench.stage));
  return scan;
}

}  // namespace lumifield
