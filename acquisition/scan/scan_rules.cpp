#include "acquisition/scan/scan_rules.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstdint>

#include "acquisition/scan/exposure_ladder.h"
#include "acquisition/stage.h"
#include "luminaire/wording.h"

namespace lumifield {

namespace {

constexpr std::int64_t most_cells = 100'000;
constexpr double longest_exposure_s = 10;
constexpr int widest_window = 64;
constexpr double scale_tolerance = 0.01;
using Box = Eigen::AlignedBox<double, 2>;
constexpr double rounding = 1e-9;  // of positions and their ratios, never of a measured length

const char* axis_name(int axis) { return axis == 0 ? "x" : "y"; }

Status check_grid(const Plan& plan) {
  if (plan.columns < 1 || plan.rows < 1) return fail("the grid has no cells", "plan: columns, rows", "give at least 1");
  const std::int64_t cells = std::int64_t{plan.columns} * plan.rows;
  if (cells > most_cells)
    return fail("the grid has " + std::to_string(cells) + " cells; a scan takes at most " + std::to_string(most_cells),
                "plan: columns, rows", "scan fewer cells");
  if (!plan.center_mm.allFinite()) return fail("not a finite position", "plan: center_mm", "give two numbers in mm");
  const CellIndex reference = plan.reference.cell;
  if (reference.row < 0 || reference.row >= plan.rows || reference.column < 0 || reference.column >= plan.columns)
    return fail("row " + std::to_string(reference.row) + ", column " + std::to_string(reference.column) +
                    " lies outside the grid of " + std::to_string(plan.rows) + " rows and " +
                    std::to_string(plan.columns) + " columns",
                "plan: reference_cell", "name a bright cell of the grid, counted from 0");
  if (plan.reference.every < 0 || plan.dark_every_cells < 0)
    return fail("a number of cells is negative", "plan: reference_cell.every, dark_every_cells", "give 0 or more");
  return {};
}

Status check_times(const Plan& plan) {
  if (plan.exposures_s.empty()) return fail("no exposure time is given", "plan: exposures_s", "give at least one");
  double last = 0;
  for (double exposure_s : plan.exposures_s) {
    if (!(exposure_s > 0 && exposure_s <= longest_exposure_s))
      return fail("an exposure of " + say(exposure_s) + " s lies outside 0 < t ≤ " + say(longest_exposure_s) + " s",
                  "plan: exposures_s", "give exposure times in seconds");
    if (exposure_s <= last)
      return fail(say(exposure_s) + " s comes after " + say(last) + " s", "plan: exposures_s",
                  "give each exposure time once, in ascending order");
    last = exposure_s;
  }
  if (!(plan.settle_s >= 0 && plan.settle_s <= 3600 && plan.warm_up_s >= 0 && plan.warm_up_s <= 86400))
    return fail("a waiting time is negative or too long", "plan: settle_s, warm_up_s",
                "settle at most 3600 s, warm up at most 86400 s");
  return {};
}

Status check_stabilisation(const Plan& plan) {
  if (!plan.stabilisation) return {};
  const auto [within, over_s, limit_s] = *plan.stabilisation;
  if (!(within > 0 && within < 1))
    return fail("a spread of " + say(within) + " is none of a steady lamp", "plan: stabilisation.within",
                "give a share above 0 and below 1, for example 0.005");
  if (!(over_s >= shortest_stabilisation_s && limit_s >= over_s && limit_s <= longest_stabilisation_s))
    return fail("watching over " + say(over_s) + " s within " + say(limit_s) + " s is not possible",
                "plan: stabilisation.over_s, limit_s",
                "watch over at least " + say(shortest_stabilisation_s) +
                    " s, and allow at least that time and at most " + say(longest_stabilisation_s) + " s");
  return {};
}

Status check_exposure_limits(const Plan& plan) {
  if (!plan.exposure_limits_s) return {};
  const char* where = "plan: exposure_limits_s";
  const auto [shortest_s, longest_s] = *plan.exposure_limits_s;
  const std::string limits = say(shortest_s) + " … " + say(longest_s) + " s";
  if (!(shortest_s > 0 && longest_s <= longest_exposure_s))
    return fail(limits + " lie outside 0 < t ≤ " + say(longest_exposure_s) + " s", where,
                "give exposure times in seconds");
  if (!(shortest_s <= plan.exposures_s.front() && longest_s >= plan.exposures_s.back()))
    return fail(limits + " do not hold the plan's exposures of " + say(plan.exposures_s.front()) + " … " +
                    say(plan.exposures_s.back()) + " s",
                where, "widen them, or leave out exposures of the plan");
  if (exposure_ladder(plan).size() > most_exposures)
    return fail("between " + limits + " lie more than " + std::to_string(most_exposures) +
                    " exposures in the ratio of the plan's",
                where, "narrow them, or give the plan's exposures a larger ratio");
  return {};
}

Status check_bench_numbers(const Bench& bench) {
  const Eigen::Matrix2d& linear = bench.stage_to_luminaire.linear;
  if (!(std::abs(linear.determinant()) > rounding * linear.squaredNorm()) ||
      !bench.stage_to_luminaire.origin_mm.allFinite())
    return fail("the matrix has no inverse: stage positions cannot be computed", "bench: stage_to_luminaire",
                "give the two columns that moving the stage by 1 mm in x and in y makes on plane U");
  if (!(bench.tolerance_mm > 0))
    return fail("the tolerance must be above 0 mm", "bench: tolerance_mm", "give the stage's repeatability, e.g. 0.02");
  // Else a place within it might be that of a neighbour, as far off on its side, and be played back as this one.
  const double most_mm = cell_step_mm(bench) / 4;
  if (bench.filter.spacing_mm.minCoeff() > 0 && !(bench.tolerance_mm < most_mm))
    return fail("a tolerance of " + say(bench.tolerance_mm) + " mm does not tell neighbouring cells apart: less than " +
                    say(most_mm) + " mm, a quarter of their spacing, does",
                "bench: tolerance_mm", "give the stage's repeatability, e.g. 0.02");
  if (!(bench.lamp_size_mm.minCoeff() > 0))
    return fail("the lamp has no size", "bench: lamp_size_mm", "give width and height of its exit in mm");
  if (!(bench.filter.spacing_mm.minCoeff() > 0))
    return fail("the spacing must be above 0 mm", "bench: filter.spacing_mm", "give the spacing printed on the slide");
  return {};
}

Status check_travel(const Bench& bench) {
  if (bench.stage.kind != "apt") return {};
  const Vec2 far = bench.stage.apt.direction.cwiseProduct(bench.stage.apt.travel_mm);
  const Box travel(far.cwiseMin(Vec2::Zero()), far.cwiseMax(Vec2::Zero()));
  if (travel.contains(Box(bench.limits.low_mm, bench.limits.high_mm))) return {};
  return fail(
      "the limits go beyond the travel, which is " + say(Vec2(travel.min())) + " to " + say(Vec2(travel.max())) + " mm",
      "bench: limits_mm", "set them within it, or correct stage.apt.travel_mm and direction");
}

Status check_scales(const FilterSlide& filter) {
  const int support = Basis(filter.basis).overlap();
  if (filter.window < support || filter.window > widest_window)
    return fail("a dual window of " + std::to_string(filter.window) + " spacings; " + std::to_string(support) + " … " +
                    std::to_string(widest_window) + " are possible with the basis " +
                    std::string(to_string(filter.basis)),
                "bench: filter.window", "give the window that the slide was printed with");
  const Dual dual(filter.basis, filter.window);
  bool positive = false, negative = dual.k_negative() < rounding;
  for (std::size_t p = 0; p < filter.passes.size(); ++p) {
    const FilterPass& pass = filter.passes[p];
    const std::string where = "bench: filter.passes[" + std::to_string(p) + "]";
    bool& present = pass.scale > 0 ? positive : negative;
    if (present)
      return fail("a filter of this sign is there already or not needed", where, "name one pass per sign of the dual");
    present = true;
    const double k = pass.scale > 0 ? dual.k_positive() : -dual.k_negative();
    if (!(std::abs(pass.scale - k) <= scale_tolerance * std::abs(k)))
      return fail("the scale " + say(pass.scale) + " is not the dual filter's " + say(k) + " within 1 %",
                  where + ".scale", "correct scale, basis or window to what the slide was printed with");
  }
  if (!positive || !negative)
    return fail(std::string("the ") + (positive ? "negative" : "positive") + " filter is missing",
                "bench: filter.passes",
                "add the pass with scale " + say(positive ? -dual.k_negative() : dual.k_positive()));
  return {};
}

Status check_cover(const Bench& bench, const Plan& plan) {
  const GridSize needed = needed_grid(bench, plan);
  if (plan.columns >= needed.columns && plan.rows >= needed.rows) return {};
  return fail(std::to_string(plan.columns) + " columns and " + std::to_string(plan.rows) +
                  " rows leave out cells whose dual window touches the lamp; it takes at least " + say(needed.columns) +
                  " columns and " + say(needed.rows) + " rows",
              "plan: columns, rows", "scan more cells, centre the grid on the lamp, or use a wider spacing");
}

Status check_separation(const Bench& bench, const Plan& plan, const std::string& name_i, const Vec2& offset_i,
                        const std::string& name_j, const Vec2& offset_j) {
  const Vec2 apart = (bench.stage_to_luminaire.linear * (offset_j - offset_i)).cwiseAbs();
  const Sampling grid = sampling_of(bench, plan);
  const Vec2 half_grid =
      Vec2(grid.columns - 1, grid.rows - 1).cwiseProduct(grid.spacing_mm) / 2 + grid.center_mm.cwiseAbs();
  const Vec2 half_lamp = bench.lamp_size_mm / 2;
  const Vec2 half_window = bench.filter.window * bench.filter.spacing_mm / 2;
  const Vec2 needed = half_grid + half_lamp + half_window;

  // Far enough along one axis is enough: only one of two places is then within reach of the lamp.
  int axis = 0;
  const double spare = (apart - needed).maxCoeff(&axis);
  if (spare >= -rounding) return {};
  return fail(name_i + " and " + name_j + " stand " + say(apart[axis]) + " mm apart along " + axis_name(axis) + "; " +
                  say(needed[axis]) + " mm are needed (half the grid " + say(half_grid[axis]) + " + half the lamp " +
                  say(half_lamp[axis]) + " + half the dual window " + say(half_window[axis]) +
                  "), or two would stand before the lamp at once",
              "bench: filter", "print them farther apart, or scan a smaller grid");
}

}  // namespace

Sampling sampling_of(const Bench& bench, const Plan& plan) {
  return {bench.filter.basis, bench.filter.spacing_mm, plan.columns, plan.rows, plan.center_mm};
}

GridSize needed_grid(const Bench& bench, const Plan& plan) {
  const Vec2 a = bench.filter.spacing_mm;
  const Vec2 reach = bench.lamp_size_mm + bench.filter.window * a + 2 * plan.center_mm.cwiseAbs();
  const auto count = [&](int axis) { return std::max(1.0, std::ceil(reach[axis] / a[axis] - rounding) - 1); };
  return {count(0), count(1)};
}

Status check_devices(const Bench& bench) {
  if (Status known = check_camera_kind(bench.camera); !known) return known;
  if (Status known = check_stage_kind(bench.stage); !known) return known;
  return check_travel(bench);
}

Status check_rules(const Bench& bench, const Plan& plan) {
  if (Status status = check_travel(bench); !status) return status;
  if (Status status = check_grid(plan); !status) return status;
  if (Status status = check_times(plan); !status) return status;
  if (Status status = check_stabilisation(plan); !status) return status;
  if (Status status = check_exposure_limits(plan); !status) return status;
  if (Status status = check_bench_numbers(bench); !status) return status;
  if (Status status = check_scales(bench.filter); !status) return status;
  if (Status status = check_cover(bench, plan); !status) return status;

  std::vector<std::pair<std::string, Vec2>> places{{"the opaque patch", bench.filter.dark_offset_mm}};
  for (const FilterPass& pass : bench.filter.passes) places.emplace_back("filter '" + pass.name + "'", pass.offset_mm);
  // Filters on slides of their own never stand before the lamp together.
  const std::size_t shared = bench.filter.change == PassChange::by_operator ? 1 : places.size();
  for (std::size_t i = 0; i < shared; ++i)
    for (std::size_t j = i + 1; j < places.size(); ++j)
      if (Status status =
              check_separation(bench, plan, places[j].first, places[j].second, places[i].first, places[i].second);
          !status)
        return status;
  return {};
}

namespace {

void extend(Box& box, const CellStep& step) {
  for (const Vec2& target : step.stage_mm) box.extend(target);
}
template <class Step>
void extend(Box& box, const Step& step) {
  box.extend(step.stage_mm);
}

}  // namespace

Status check_limits(const Bench& bench, const std::vector<ScanStep>& steps) {
  Box box;
  for (const ScanStep& step : steps) std::visit([&](const auto& s) { extend(box, s); }, step);
  if (box.isEmpty()) return {};
  const bool approaches = !bench.stage.approach_mm.isZero(0);
  box.extend(Box(box.min() - bench.stage.approach_mm, box.max() - bench.stage.approach_mm));

  std::string beyond;
  for (int axis : {0, 1}) {
    const double low = box.min()[axis], high = box.max()[axis];
    const double below = bench.limits.low_mm[axis] - low, above = high - bench.limits.high_mm[axis];
    if (below <= rounding && above <= rounding) continue;
    if (!beyond.empty()) beyond += ", ";
    beyond += std::string("stage ") + axis_name(axis) + " from " + say(low) + " to " + say(high) + " mm";
    if (below > rounding) beyond += ", " + say(below) + " mm below the low limit";
    if (above > rounding) beyond += ", " + say(above) + " mm above the high limit";
  }
  if (beyond.empty()) return {};
  if (approaches) beyond += "; the approach by " + say(bench.stage.approach_mm) + " mm is counted";
  return fail("the scan needs " + beyond, "bench: limits_mm",
              "if the stage can travel there, set the limits to at least " + say(Vec2(box.min())) + " … " +
                  say(Vec2(box.max())) + " mm; else scan a smaller grid" +
                  (approaches ? ", approach from the other side" : "") + " or move its centre");
}

}  // namespace lumifield
