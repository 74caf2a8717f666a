#include "acquisition/scan/scan_plan.h"

#include <Eigen/LU>
#include <algorithm>
#include <numeric>

#include "acquisition/scan/motion_time.h"
#include "acquisition/scan/scan_order.h"
#include "acquisition/scan/scan_rules.h"

namespace lumifield {

namespace {

bool by_hand(const Bench& bench) { return bench.filter.change == PassChange::by_operator; }

const Vec2& offset_mm(const Bench& bench, int pass) {
  return bench.filter.passes[static_cast<std::size_t>(pass)].offset_mm;
}

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

/// `first_block`: of the dark sets. `pass`: the one before the lamp where the operator changes it.
std::vector<ScanStep> make_steps(const Bench& bench, const Plan& plan, const std::vector<CellIndex>& cells,
                                 int first_block, int pass) {
  const Vec2 dark = dark_target_mm(bench);
  const Vec2 reference = reference_target_mm(bench, plan, pass);
  const auto due = [](int done, int every) { return done == 0 || (every > 0 && done % every == 0); };

  std::vector<ScanStep> steps;
  Vec2 at = dark;
  int blocks = first_block;
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
    const CellStep step = make_cell_step(bench, plan, cells[static_cast<std::size_t>(done)], at, pass);
    at = step.stage_mm.back();
    steps.emplace_back(step);
  }
  if (count > 0) steps.emplace_back(ReferenceStep{reference, count});
  return steps;
}

/// Pass by pass, each with its dark sets and readings of the reference cell.
std::vector<ScanStep> make_steps_by_hand(const Bench& bench, const Plan& plan, const std::vector<CellIndex>& cells,
                                         const PassCells& taken) {
  std::vector<ScanStep> steps;
  for (std::size_t p = 0; p < bench.filter.passes.size(); ++p) {
    std::vector<CellIndex> left = cells;
    if (p < taken.size()) std::erase_if(left, [&](CellIndex cell) { return taken[p].contains(cell); });
    if (left.empty()) continue;
    const int pass = static_cast<int>(p);
    const int blocks = static_cast<int>(
        std::ranges::count_if(steps, [](const ScanStep& step) { return std::holds_alternative<DarkStep>(step); }));
    const auto before = plan.columns * plan.rows - static_cast<int>(left.size());
    steps.emplace_back(SlideStep{dark_target_mm(bench), pass, before});
    for (ScanStep& step : make_steps(bench, plan, left, blocks, pass)) steps.push_back(std::move(step));
  }
  return steps;
}

}  // namespace

Vec2 stage_target_mm(const Bench& bench, const Vec2& u_mm) {
  const Vec2 image = bench.stage_carries == StageCarries::lamp ? Vec2(-u_mm) : u_mm;
  return bench.stage_to_luminaire.linear.inverse() * (image - bench.stage_to_luminaire.origin_mm);
}

Vec2 dark_target_mm(const Bench& bench) { return stage_target_mm(bench, Vec2(0, 0)) + bench.filter.dark_offset_mm; }

Vec2 reference_target_mm(const Bench& bench, const Plan& plan, int pass) {
  return stage_target_mm(bench, sampling_of(bench, plan).cell_center_mm(plan.reference.cell)) + offset_mm(bench, pass);
}

CellStep make_cell_step(const Bench& bench, const Plan& plan, CellIndex cell, const Vec2& from_mm, int pass) {
  if (by_hand(bench))
    return {
        cell, {pass}, {stage_target_mm(bench, sampling_of(bench, plan).cell_center_mm(cell)) + offset_mm(bench, pass)}};
  return cell_step(bench, sampling_of(bench, plan), cell, from_mm, stage_speed(bench.stage));
}

Result<ScanPlan> make_scan_plan(const Bench& bench, const Plan& plan, const std::set<CellIndex>& done,
                                const PassCells& taken) {
  if (Status status = check_rules(bench, plan); !status) return tl::unexpected(status.error());

  std::vector<CellIndex> cells = scan_order(plan.order, plan.columns, plan.rows);
  std::erase_if(cells, [&](CellIndex cell) { return done.contains(cell); });
  const int to_scan = static_cast<int>(cells.size());
  ScanPlan scan{by_hand(bench) ? make_steps_by_hand(bench, plan, cells, taken) : make_steps(bench, plan, cells, 0, 0),
                to_scan, plan.columns * plan.rows - to_scan, 0};
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
