#include "acquisition/scan/scan_rules.h"

#include <cmath>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <limits>
#include <random>

#include "tests/support/small_bench.h"

namespace lumifield {
namespace {

using test::bell_bench;
using test::bell_plan;
using ::testing::HasSubstr;

Error refusal(const Bench& bench, const Plan& plan) {
  const auto scan = make_scan_plan(bench, plan);
  EXPECT_FALSE(scan);
  return scan ? Error{} : scan.error();
}

TEST(ScanRules, LimitsSayAxisExcessAndWhatIsNeeded) {
  Bench bench = bell_bench();
  bench.limits.high_mm.x() = 100;
  const Error error = refusal(bench, bell_plan());
  EXPECT_THAT(error.where, HasSubstr("limits_mm"));
  EXPECT_THAT(error.what, HasSubstr("stage x from -30 to 120 mm, 20 mm above the high limit"));
  EXPECT_THAT(error.what, Not(HasSubstr("stage y")));
  EXPECT_THAT(error.remedy, HasSubstr("(-30, -22.5) … (120, 90)"));

  bench.limits = {{-30, -22.5}, {120, 90}};
  EXPECT_TRUE(make_scan_plan(bench, bell_plan()));
  bench.limits.low_mm.y() = -20;
  EXPECT_THAT(refusal(bench, bell_plan()).what, HasSubstr("stage y from -22.5 to 90 mm, 2.5 mm below the low limit"));
}

TEST(ScanRules, LimitsOfThorlabsStagesLieWithinTheirTravel) {
  Bench bench = bell_bench();
  bench.stage.kind = "apt";
  bench.stage.apt.travel_mm = {130, 100};
  bench.stage.apt.direction = {1, -1};
  bench.limits = {{0, -100}, {130, 0}};
  EXPECT_TRUE(check_devices(bench));
  bench.limits.high_mm.y() = 1;
  EXPECT_THAT(refusal(bench, bell_plan()).what,
              HasSubstr("the limits go beyond the travel, which is (0, -100) to (130, 0) mm"));
  bench.stage.kind = "grbl";
  EXPECT_TRUE(check_devices(bench));
}

TEST(ScanRules, KindsOfDevicesAreKnown) {
  Bench bench = bell_bench();
  bench.camera.kind = "usb3";
  EXPECT_THAT(check_devices(bench).error().message(),
              testing::AllOf(HasSubstr("\"usb3\""), HasSubstr("aravis (GigE Vision and USB3 Vision)")));
  bench = bell_bench();
  bench.stage.kind = "hexapod";
  EXPECT_THAT(check_devices(bench).error().message(), testing::AllOf(HasSubstr("\"hexapod\""), HasSubstr("grbl")));
}

TEST(ScanRules, LimitsHoldWhereTargetsAreApproachedFrom) {
  Bench bench = bell_bench();
  bench.limits = {{-30, -22.5}, {120, 90}};
  bench.stage.approach_mm = {1, -2};
  const Error error = refusal(bench, bell_plan());
  EXPECT_THAT(error.what,
              HasSubstr("stage x from -31 to 120 mm, 1 mm below the low limit, stage y from -22.5 to 92 mm, "
                        "2 mm above the high limit; the approach by (1, -2) mm is counted"));
  EXPECT_THAT(error.remedy, HasSubstr("(-31, -22.5) … (120, 92)"));
  bench.limits = {{-31, -22.5}, {120, 92}};
  EXPECT_TRUE(make_scan_plan(bench, bell_plan()));
}

TEST(ScanRules, StabilisationIsPossible) {
  Plan plan = bell_plan();
  plan.stabilisation = Stabilisation{0.005, 60, 60};
  EXPECT_TRUE(make_scan_plan(bell_bench(), plan));
  for (const double within : {0.0, 1.0, -0.1, std::nan("")}) {
    plan.stabilisation->within = within;
    EXPECT_THAT(refusal(bell_bench(), plan).where, HasSubstr("stabilisation.within"));
  }
  for (const auto& [over_s, limit_s] : {std::pair(0.9, 60.0), {60, 59}, {60, 86'401}, {60, std::nan("")}}) {
    plan.stabilisation = Stabilisation{0.005, over_s, limit_s};
    EXPECT_THAT(refusal(bell_bench(), plan).where, HasSubstr("stabilisation.over_s, limit_s"));
  }
}

TEST(ScanRules, FiltersStandFarEnoughApart) {
  // 30 mm half the grid, 18 mm half the lamp, 15 mm half the window.
  Bench bench = bell_bench();
  bench.filter.passes[1].offset_mm = {62.9, 0};
  EXPECT_THAT(refusal(bench, bell_plan()).what, HasSubstr("stand 62.9 mm apart along x; 63 mm are needed"));
  bench.filter.passes[1].offset_mm = {63, 0};
  EXPECT_TRUE(make_scan_plan(bench, bell_plan()));

  // The opaque patch, along y: 22.5 + 11 + 15. An offset grid reaches farther to one side.
  bench.filter.dark_offset_mm = {0, 48.4};
  EXPECT_THAT(refusal(bench, bell_plan()).what, HasSubstr("opaque patch stand 48.4 mm apart along y; 48.5 mm"));
  bench.filter.dark_offset_mm = {0, 48.5};
  EXPECT_TRUE(make_scan_plan(bench, bell_plan()));
  Plan shifted = bell_plan();
  shifted.center_mm = {0, 0.2};
  EXPECT_THAT(refusal(bench, shifted).what, HasSubstr("48.7 mm are needed"));
}

TEST(ScanRules, OneAxisFarEnoughApartIsEnough) {
  // 63 mm are needed along x, 48.5 mm along y: the larger distance need not be the one that suffices.
  Bench bench = bell_bench();
  bench.filter.dark_offset_mm = {0, -70};
  bench.filter.passes[1].offset_mm = {60, 48.5};
  bench.limits = {{-500, -500}, {500, 500}};
  const auto scan = make_scan_plan(bench, bell_plan());
  EXPECT_TRUE(scan) << scan.error().message();

  // Neither suffices: told is the one that lacks least.
  bench.filter.passes[1].offset_mm = {60, 48};
  EXPECT_THAT(refusal(bench, bell_plan()).what, HasSubstr("stand 48 mm apart along y; 48.5 mm are needed"));
}

TEST(ScanRules, ApartCountsOnPlaneU) {
  Bench bench = bell_bench();
  bench.stage_to_luminaire.linear << 0.5, 0, 0, 1;
  bench.limits = {{-500, -500}, {500, 500}};
  EXPECT_THAT(refusal(bench, bell_plan()).what, HasSubstr("stand 45 mm apart along x; 63 mm are needed"));
}

TEST(ScanRules, TheGridHoldsEveryCellWhoseDualWindowTouchesTheLamp) {
  Plan plan = bell_plan();
  plan.columns = 7;
  plan.rows = 5;
  plan.reference.cell = {2, 3};
  EXPECT_THAT(refusal(bell_bench(), plan).what, HasSubstr("at least 8 columns and 6 rows"));

  // Against the definition, cell by cell beyond the grid's edges.
  std::mt19937 random(5);
  std::uniform_real_distribution<double> size(1, 50), spacing(2, 12), shift(-6, 6);
  std::uniform_int_distribution<int> count(1, 20);
  Bench bench = bell_bench();
  int complete_grids = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    bench.lamp_size_mm = {size(random), size(random)};
    bench.filter.spacing_mm = {spacing(random), spacing(random)};
    plan.columns = count(random);
    plan.rows = count(random);
    plan.center_mm = {shift(random), shift(random)};
    const Vec2 reach = bench.lamp_size_mm / 2 + bench.filter.window * bench.filter.spacing_mm / 2;
    bool complete = true;
    for (int axis : {0, 1}) {
      const int n = axis == 0 ? plan.columns : plan.rows;
      for (int outside = 0; outside < 40; ++outside)
        for (int j : {-1 - outside, n + outside}) {
          const double u = plan.center_mm[axis] + (j - (n - 1) / 2.0) * bench.filter.spacing_mm[axis];
          if (std::abs(u) < reach[axis]) complete = false;
        }
    }
    complete_grids += complete;
    const GridSize needed = needed_grid(bench, plan);
    EXPECT_EQ(plan.columns >= needed.columns && plan.rows >= needed.rows, complete) << "trial " << trial;
  }
  EXPECT_GT(complete_grids, 200);
}

TEST(ScanRules, ScalesAreTheDuals) {
  Bench bench = bell_bench();
  bench.filter.passes[0].scale *= 1.009;
  EXPECT_TRUE(make_scan_plan(bench, bell_plan()));
  bench.filter.passes[0].scale = 2.07;
  EXPECT_THAT(refusal(bench, bell_plan()).what, HasSubstr("scale 2.07 is not the dual filter's 1.879"));
  EXPECT_THAT(refusal(bench, bell_plan()).where, HasSubstr("passes[0].scale"));

  bench = bell_bench();
  bench.filter.passes.pop_back();
  EXPECT_THAT(refusal(bench, bell_plan()).what, HasSubstr("negative filter is missing"));
  bench.filter.passes.push_back(bench.filter.passes[0]);
  EXPECT_THAT(refusal(bench, bell_plan()).where, HasSubstr("passes[1]"));
  bench.filter.passes[1].scale = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(refusal(bench, bell_plan()).where, HasSubstr("passes[1].scale"));
  bench.filter.passes.clear();
  EXPECT_THAT(refusal(bench, bell_plan()).what, HasSubstr("positive filter is missing"));

  for (const int window : {0, 1, 1'000'000'000}) {
    bench = bell_bench();
    bench.filter.window = window;
    EXPECT_THAT(refusal(bench, bell_plan()).where, HasSubstr("window"));
  }
}

TEST(ScanRules, ABoxSlideHasNoNegativeFilter) {
  Bench bench = bell_bench();
  bench.filter.basis = BasisKind::box;
  bench.filter.window = 1;
  bench.filter.passes = {{"open", {0, 0}, 1}};
  EXPECT_TRUE(make_scan_plan(bench, bell_plan()));
  bench.filter.passes.push_back({"negative", {90, 0}, -0.1});
  EXPECT_THAT(refusal(bench, bell_plan()).where, HasSubstr("passes[1]"));
}

TEST(ScanRules, ExposuresAscendWithinTenSeconds) {
  Plan plan = bell_plan();
  for (const double wrong : {0.0, -1.0, 10.5, std::numeric_limits<double>::quiet_NaN()}) {
    plan.exposures_s = {wrong};
    EXPECT_THAT(refusal(bell_bench(), plan).where, HasSubstr("exposures_s"));
  }
  plan.exposures_s = {0.1, 0.1};
  EXPECT_THAT(refusal(bell_bench(), plan).what, HasSubstr("0.1 s comes after 0.1 s"));
  plan.exposures_s = {};
  EXPECT_THAT(refusal(bell_bench(), plan).what, HasSubstr("no exposure"));
  plan.exposures_s = {10};
  EXPECT_TRUE(make_scan_plan(bell_bench(), plan));
}

TEST(ScanRules, ExposureLimitsHoldThePlansExposures) {
  Plan plan = bell_plan();  // 0.002 … 0.032 s
  for (const ExposureLimits right : {ExposureLimits{0.002, 0.032}, ExposureLimits{1e-5, 10}}) {
    plan.exposure_limits_s = right;
    EXPECT_TRUE(make_scan_plan(bell_bench(), plan));
  }
  for (const ExposureLimits wrong : {ExposureLimits{0, 1}, ExposureLimits{0.001, 10.5}}) {
    plan.exposure_limits_s = wrong;
    EXPECT_THAT(refusal(bell_bench(), plan).what, HasSubstr("outside 0 < t ≤ 10 s"));
  }
  for (const ExposureLimits wrong : {ExposureLimits{0.003, 1}, ExposureLimits{0.001, 0.03}}) {
    plan.exposure_limits_s = wrong;
    EXPECT_THAT(refusal(bell_bench(), plan).what, HasSubstr("do not hold the plan's exposures of 0.002 … 0.032 s"));
  }
  plan.exposures_s = {0.002, 0.00200001};
  plan.exposure_limits_s = {0.001, 1};
  EXPECT_THAT(refusal(bell_bench(), plan).what, HasSubstr("more than 64 exposures"));
  EXPECT_EQ(refusal(bell_bench(), plan).where, "plan: exposure_limits_s");
}

TEST(ScanRules, RefusesWhatCannotBeScanned) {
  Plan plan = bell_plan();
  plan.reference.cell = {7, 0};
  EXPECT_THAT(refusal(bell_bench(), plan).what, HasSubstr("row 7, column 0 lies outside the grid of 7 rows"));
  plan = bell_plan();
  plan.columns = 1'000'000'000;
  plan.rows = 1'000'000'000;
  EXPECT_THAT(refusal(bell_bench(), plan).what, HasSubstr("1000000000000000000 cells"));
  plan.columns = 0;
  EXPECT_THAT(refusal(bell_bench(), plan).where, HasSubstr("columns"));
  plan = bell_plan();
  plan.settle_s = -1;
  EXPECT_THAT(refusal(bell_bench(), plan).where, HasSubstr("settle_s"));

  Bench bench = bell_bench();
  bench.stage_to_luminaire.linear << 1, 2, 2, 4;
  EXPECT_THAT(refusal(bench, bell_plan()).where, HasSubstr("stage_to_luminaire"));
  bench = bell_bench();
  bench.tolerance_mm = 0;
  EXPECT_THAT(refusal(bench, bell_plan()).where, HasSubstr("tolerance_mm"));
  bench.tolerance_mm = 1.87;
  EXPECT_TRUE(make_scan_plan(bench, bell_plan()));
  bench.tolerance_mm = 1.88;
  EXPECT_THAT(refusal(bench, bell_plan()).what,
              HasSubstr("a tolerance of 1.88 mm does not tell neighbouring cells apart: less than 1.875 mm"));
  bench = bell_bench();
  bench.filter.spacing_mm.x() = 0;
  EXPECT_THAT(refusal(bench, bell_plan()).where, HasSubstr("spacing_mm"));
}

}  // namespace
}  // namespace lumifield
