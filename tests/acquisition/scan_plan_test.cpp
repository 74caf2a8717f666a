#include "acquisition/scan/scan_plan.h"

#include <cmath>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <limits>
#include <random>

#include "acquisition/scan/motion_time.h"
#include "acquisition/scan/scan_order.h"
#include "acquisition/scan/scan_rules.h"
#include "tests/support/small_bench.h"

namespace lumifield {
namespace {

using test::bell_bench;
using test::bell_plan;
using test::small_bench;
using test::small_plan;
using ::testing::HasSubstr;

template <class Step>
std::vector<Step> steps_of(const ScanPlan& scan) {
  std::vector<Step> found;
  for (const ScanStep& step : scan.steps)
    if (const Step* s = std::get_if<Step>(&step)) found.push_back(*s);
  return found;
}

TEST(StageTarget, InvertsTheSlidesAndTheLampsFrame) {
  Bench bench = bell_bench();
  bench.stage_to_luminaire.linear << 0, -1.01, 0.99, 0.02;
  bench.stage_to_luminaire.origin_mm = {-30, 12};
  const Vec2 u(7.5, -22.5);
  Vec2 q = stage_target_mm(bench, u);
  EXPECT_LT((bench.stage_to_luminaire.linear * q + bench.stage_to_luminaire.origin_mm - u).norm(), 1e-12);
  EXPECT_EQ(lamp_displacement_mm(bench, q), Vec2(0, 0));

  bench.stage_carries = StageCarries::lamp;
  q = stage_target_mm(bench, u);
  EXPECT_LT((lamp_displacement_mm(bench, q) + u).norm(), 1e-12);
}

TEST(ScanPlan, TargetsAddThePassOffsetsInStageCoordinates) {
  for (const StageCarries carries : {StageCarries::slide, StageCarries::lamp}) {
    Bench bench = bell_bench();
    bench.stage_carries = carries;
    bench.limits = {{-500, -500}, {500, 500}};
    bench.filter.passes[0].offset_mm = {3, -1};
    bench.stage_to_luminaire.origin_mm = {5, 6};
    const Plan plan = bell_plan();
    const auto scan = make_scan_plan(bench, plan);
    ASSERT_TRUE(scan) << scan.error().message();
    const double sign = carries == StageCarries::lamp ? -1 : 1;
    for (const CellStep& step : steps_of<CellStep>(*scan))
      for (std::size_t k = 0; k < step.pass_order.size(); ++k) {
        const Vec2 u((step.cell.column - 4) * 7.5, (step.cell.row - 3) * 7.5);
        const Vec2 offset = step.pass_order[k] == 0 ? Vec2(3, -1) : Vec2(90, 0);
        EXPECT_LT((step.stage_mm[k] - (sign * u - Vec2(5, 6) + offset)).norm(), 1e-12);
      }
    EXPECT_EQ(steps_of<DarkStep>(*scan)[0].stage_mm, Vec2(-5, 84));
    EXPECT_EQ(steps_of<ReferenceStep>(*scan)[0].stage_mm, Vec2(-2, -7));
  }
}

TEST(ScanPlan, DarkAndReferenceOpenReturnAndTheReferenceCloses) {
  const auto scan = make_scan_plan(bell_bench(), bell_plan());
  ASSERT_TRUE(scan) << scan.error().message();
  EXPECT_EQ(scan->cells, 63);
  ASSERT_TRUE(std::holds_alternative<DarkStep>(scan->steps[0]));
  ASSERT_TRUE(std::holds_alternative<ReferenceStep>(scan->steps[1]));
  ASSERT_TRUE(std::holds_alternative<ReferenceStep>(scan->steps.back()));

  std::vector<int> dark_at, reference_at;
  int cells = 0;
  for (const ScanStep& step : scan->steps) {
    if (const auto* dark = std::get_if<DarkStep>(&step)) {
      EXPECT_EQ(dark->block, static_cast<int>(dark_at.size()));
      dark_at.push_back(cells);
    } else if (const auto* reference = std::get_if<ReferenceStep>(&step)) {
      EXPECT_EQ(reference->cells_done, cells);
      reference_at.push_back(cells);
    } else {
      ++cells;
    }
  }
  EXPECT_EQ(dark_at, (std::vector<int>{0, 21, 42}));
  EXPECT_EQ(reference_at, (std::vector<int>{0, 10, 20, 30, 40, 50, 60, 63}));
}

TEST(ScanPlan, MakesTheLongMoveOnceACell) {
  Plan plan = bell_plan();
  plan.dark_every_cells = 0;
  plan.reference.every = 0;
  const auto scan = make_scan_plan(bell_bench(), plan);
  ASSERT_TRUE(scan);
  const auto cells = steps_of<CellStep>(*scan);
  EXPECT_EQ(cells[0].pass_order, (std::vector<int>{0, 1}));
  for (std::size_t n = 1; n < cells.size(); ++n) {
    EXPECT_EQ(cells[n].pass_order.front(), cells[n - 1].pass_order.back());
    EXPECT_LE((cells[n].stage_mm.front() - cells[n - 1].stage_mm.back()).norm(), 7.5 + 1e-9);
  }
}

TEST(ScanPlan, LeavesOutCellsThatAreDone) {
  const std::set<CellIndex> done{{0, 1}, {1, 2}};
  const auto scan = make_scan_plan(small_bench(), small_plan(), done);
  ASSERT_TRUE(scan);
  EXPECT_EQ(scan->cells, 4);
  EXPECT_EQ(scan->cells_before, 2);
  EXPECT_EQ(steps_of<CellStep>(*scan).size(), 4U);
  for (const CellStep& step : steps_of<CellStep>(*scan)) EXPECT_FALSE(done.contains(step.cell));
  EXPECT_EQ(steps_of<ReferenceStep>(*scan).back().cells_done, 4);

  const auto nothing = make_scan_plan(small_bench(), small_plan(), {{0, 0}, {0, 1}, {0, 2}, {1, 0}, {1, 1}, {1, 2}});
  ASSERT_TRUE(nothing);
  EXPECT_TRUE(nothing->steps.empty());
  EXPECT_EQ(nothing->predicted_s, 0);
}

TEST(ScanOrder, SerpentineTurnsAtEveryRow) {
  EXPECT_EQ(scan_order(ScanOrder::serpentine, 3, 2),
            (std::vector<CellIndex>{{0, 0}, {0, 1}, {0, 2}, {1, 2}, {1, 1}, {1, 0}}));
}

TEST(ScanOrder, CoarseToFineTakesTheLatticesThroughTheCentreInTurn) {
  const auto order = scan_order(ScanOrder::coarse_to_fine, 9, 7);
  EXPECT_EQ(order[0], (CellIndex{3, 4}));
  std::size_t n = 0;
  std::set<CellIndex> visited;
  for (const int stride : {8, 4, 2, 1}) {
    std::set<CellIndex> lattice;
    for (int row = 3 % stride; row < 7; row += stride)
      for (int column = 4 % stride; column < 9; column += stride) lattice.insert({row, column});
    while (visited.size() < lattice.size()) visited.insert(order[n++]);
    EXPECT_EQ(visited, lattice) << "stride " << stride;
  }
}

TEST(ScanOrder, VisitsEveryCellOnce) {
  for (const ScanOrder kind : {ScanOrder::serpentine, ScanOrder::coarse_to_fine})
    for (int columns = 1; columns <= 17; ++columns)
      for (int rows = 1; rows <= 17; rows += 3) {
        const auto order = scan_order(kind, columns, rows);
        EXPECT_EQ(order.size(), static_cast<std::size_t>(columns * rows));
        EXPECT_EQ(std::set<CellIndex>(order.begin(), order.end()).size(), order.size());
      }
}

TEST(MotionTime, IsATrapezoidOnTheLongerAxis) {
  const StageSpeed speed{50, 500};
  EXPECT_DOUBLE_EQ(move_time_s(speed, {0, 0}, {0, 0}), 0);
  EXPECT_DOUBLE_EQ(move_time_s(speed, {0, 0}, {1.25, 1}), 0.1);        // 2 √(1.25/500): never reaches 50 mm/s
  EXPECT_DOUBLE_EQ(move_time_s(speed, {0, 0}, {-5, 5}), 0.2);          // just reaches it
  EXPECT_DOUBLE_EQ(move_time_s(speed, {10, 0}, {10, 90}), 1.8 + 0.1);  // way/v + v/a
}

TEST(MotionTime, TakesTheBenchsSpeedThenTheControllersThenTheDefault) {
  StageSettings settings;
  EXPECT_EQ(stage_speed(settings).rapid_mm_s, 10);
  EXPECT_EQ(stage_speed(settings, {80, 0}).rapid_mm_s, 80);
  EXPECT_EQ(stage_speed(settings, {80, 0}).acceleration_mm_s2, 50);
  settings.rapid_mm_s = 30;
  EXPECT_EQ(stage_speed(settings, {80, 0}).rapid_mm_s, 30);
}

TEST(MotionTime, PredictsAScanOfOneCell) {
  Plan plan = small_plan();
  plan.warm_up_s = 7;
  const auto scan = make_scan_plan(small_bench(), plan, {{0, 0}, {0, 1}, {0, 2}, {1, 0}, {1, 2}});
  ASSERT_TRUE(scan);
  // Dark (0, 90), reference (0, 3.75), positive there, negative (90, 3.75), reference again.
  const double standing = 0.1 + 0.042 + 3 * 0.02;
  const double moves = (86.25 / 50 + 0.1) + 0 + 2 * (90 / 50.0 + 0.1);
  EXPECT_NEAR(scan->predicted_s, 7 + 5 * standing + moves, 1e-12);
}

TEST(MotionTime, CountsTheDarkSetWithAllThatThePlanAllows) {
  Plan plan = small_plan();
  const std::set<CellIndex> all_but_one{{0, 0}, {0, 1}, {0, 2}, {1, 0}, {1, 2}};
  const double before_s = make_scan_plan(small_bench(), plan, all_but_one)->predicted_s;
  plan.exposure_limits_s = {0.0005, 0.2};
  EXPECT_NEAR(make_scan_plan(small_bench(), plan, all_but_one)->predicted_s - before_s, 0.0005 + 0.128 + 2 * 0.02,
              1e-12);
}

TEST(MotionTime, ATargetIsComeToFromOneSide) {
  const Vec2 target(10, 20);
  const auto via = std::vector<Vec2>{{9, 22}, {10, 20}};
  const auto straight = std::vector<Vec2>{{10, 20}};
  EXPECT_EQ(way_to(target, {0, 0}, std::nullopt), straight);
  EXPECT_EQ(way_to(target, {1, -2}, std::nullopt), via);
  EXPECT_EQ(way_to(target, {1, -2}, Vec2(9, 22)), straight);
  EXPECT_EQ(way_to(target, {1, -2}, Vec2(0, 90)), straight);
  EXPECT_EQ(way_to(target, {1, -2}, Vec2(9.5, 90)), via) << "not far enough in x";
  EXPECT_EQ(way_to(target, {1, -2}, Vec2(0, 0)), via) << "the wrong way in y";
  EXPECT_EQ(way_to(target, {1, 0}, Vec2(0, 50)), straight) << "y does not matter";
}

TEST(MotionTime, CountsTheApproach) {
  Bench bench = small_bench();
  const auto predicted_s = [&] {
    return make_scan_plan(bench, small_plan(), {{0, 0}, {0, 1}, {0, 2}, {1, 0}, {1, 2}})->predicted_s;
  };
  const double straight_s = predicted_s();
  bench.stage.approach_mm = {0, 1.25};
  // Up to each of five targets from 1.25 mm below, for the second 1.25 mm farther down, for the third, where the stage
  // stands already, down first.
  EXPECT_NEAR(predicted_s() - straight_s, 5 * 0.1 + 1.25 / 50 + 0.1, 1e-12);
}

TEST(TimeLeft, FollowsThePace) {
  TimeLeft left({10, 10, 20});
  EXPECT_DOUBLE_EQ(left.left_s(0), 40);
  EXPECT_DOUBLE_EQ(left.left_s(4), 36);
  left.step_done(22);  // (22 + 2)/(10 + 2): twice as slow as predicted
  EXPECT_DOUBLE_EQ(left.left_s(22), 60);
  left.step_done(44);
  left.step_done(80);
  EXPECT_DOUBLE_EQ(left.left_s(80), 0);
}

TEST(Rehearsal, GoesToTheCornersOfEveryPassTheReferenceCellAndTheShot) {
  const Bench bench = test::bell_bench();
  const Plan plan = test::bell_plan();
  const auto steps = make_rehearsal(bench, plan, {2, 5});
  ASSERT_TRUE(steps) << steps.error().message();
  ASSERT_EQ(steps->steps.size(), 1U + 2 * 4 + 2);
  EXPECT_TRUE(std::holds_alternative<DarkStep>(steps->steps.front()));
  const auto corner = std::get<VisitStep>(steps->steps[2 + 4]);
  EXPECT_EQ(corner.place, "corner cell (0, 8), pass negative");
  EXPECT_NEAR(corner.stage_mm.x(), 30 + 90, 1e-12);
  EXPECT_NEAR(corner.stage_mm.y(), -22.5, 1e-12);
  EXPECT_TRUE(std::holds_alternative<ReferenceStep>(steps->steps[9]));
  EXPECT_EQ(std::get<CellStep>(steps->steps[10]).cell, (CellIndex{2, 5}));
  EXPECT_EQ(steps->cells, 1);
  // Of 8 corners no exposures are counted.
  const double standing = 0.1 + 0.042 + 3 * 0.02;
  EXPECT_LT(steps->predicted_s, 4 * standing + 8 * 0.1 + 10 * move_time_s({50, 500}, {0, 0}, {150, 0}));
  EXPECT_GT(steps->predicted_s, 4 * standing + 8 * 0.1);
}

TEST(Rehearsal, RefusesWhatTheScanWouldAndACellBesideTheGrid) {
  Bench bench = test::bell_bench();
  EXPECT_THAT(make_rehearsal(bench, test::bell_plan(), {7, 0}).error().message(),
              testing::HasSubstr("test shot: there is no cell (7, 0) in a grid of 7 rows and 9 columns"));
  bench.limits.high_mm = {100, 100};
  EXPECT_THAT(make_rehearsal(bench, test::bell_plan(), {2, 5}).error().where, testing::HasSubstr("limits_mm"));
}

}  // namespace
}  // namespace lumifield
