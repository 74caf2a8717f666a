#include "app/session/study_plots.h"

#include <cmath>
#include <gtest/gtest.h>
#include <limits>

namespace lumifield {
namespace {

StudyPoint point(Method method, const std::string& luminaire, double cost, double time_ms, double rel_rmse) {
  return {method, luminaire, cost, time_ms, rel_rmse, 0, "pthread", 256, 192};
}

TEST(StudyPlots, ALineGoesByCostAndEndsInTheExactPoint) {
  Study study;
  study.points = {
      point(Method::position_dependent, "bike", 800, 40, 0.02), point(Method::closed_form, "bike", 0, 90, 0),
      point(Method::closed_form, "bike", 8, 30, 0.002),         point(Method::closed_form, "bike", 2, 4, 0.03),
      point(Method::closed_form, "bike", 16, 50, 9e-6),         point(Method::position_dependent, "bike", 50, 3, 0.08)};
  const StudyPlots plots = plots_of(study);
  ASSERT_EQ(plots.plots.size(), 1U);
  const auto& series = plots.plots[0].series;
  ASSERT_EQ(series.size(), 2U);
  EXPECT_EQ(series[0].method, Method::closed_form);
  ASSERT_EQ(series[0].line.size(), 2U);
  EXPECT_EQ(series[0].line[0].cost, 2);
  EXPECT_EQ(series[0].line[1].cost, 8);
  ASSERT_EQ(series[0].exact.size(), 2U);  // 9e-6 is 0.0009 %
  EXPECT_EQ(series[0].exact[0].cost, 16);
  EXPECT_EQ(series[0].exact[1].cost, 0);
  EXPECT_EQ(series[1].line[0].cost, 50);
  EXPECT_EQ(plots.time_from_ms, 2);
  EXPECT_EQ(plots.time_to_ms, 100);
  EXPECT_NEAR(plots.error_from_percent, 0.1, 1e-12);
  EXPECT_NEAR(plots.error_to_percent, 10, 1e-12);
}

TEST(StudyPlots, ConfirmingPointsOfAnotherSizeAndWhatIsNotFiniteAreCounted) {
  Study study;
  study.points = {point(Method::far_field, "car2", 0, 20, 0.3), point(Method::far_field, "bike", 0, 1, 0.2),
                  point(Method::far_field, "bike", 0, 16, 0.2),
                  point(Method::uniform_box, "bike", 8, 2, std::numeric_limits<double>::quiet_NaN()),
                  point(Method::uniform_box, "bike", 16, std::numeric_limits<double>::infinity(), 0.1)};
  study.points[2].width_px = 1024;
  study.points[2].height_px = 768;
  const StudyPlots plots = plots_of(study);
  EXPECT_EQ(plots.width_px, 256);
  EXPECT_EQ(plots.other_size, 1);
  EXPECT_EQ(plots.not_finite, 2);
  ASSERT_EQ(plots.plots.size(), 2U);
  EXPECT_EQ(plots.plots[0].luminaire, "car2");
  ASSERT_EQ(plots.plots[1].series.size(), 1U);
  EXPECT_EQ(plots.plots[1].series[0].line.size(), 1U);
}

TEST(StudyPlots, WhatNoPictureTakesIsCountedAndLeavesTheAxes) {
  Study study;
  study.points = {point(Method::closed_form, "bike", 4, 10, 0.1), point(Method::closed_form, "bike", 8, 100, 0.01)};
  const StudyPlots sound = plots_of(study);
  int extreme = 0;
  for (const double time_ms : {5e-324, 1e-300, 0.0, -1.0, 1e10, 1e300, 1.7e308}) {
    study.points.push_back(point(Method::closed_form, "bike", 16, time_ms, 0.1));
    ++extreme;
  }
  for (const double rel_rmse : {-1e-300, -1.0, 1e4, 1e300, 1.7e308}) {
    study.points.push_back(point(Method::closed_form, "bike", 16, 10, rel_rmse));
    ++extreme;
  }
  const StudyPlots plots = plots_of(study);
  EXPECT_EQ(plots.out_of_range, extreme);
  EXPECT_EQ(plots.not_finite, 0);
  EXPECT_EQ(plots.time_from_ms, sound.time_from_ms);
  EXPECT_EQ(plots.time_to_ms, sound.time_to_ms);
  EXPECT_EQ(plots.error_from_percent, sound.error_from_percent);
  EXPECT_EQ(plots.error_to_percent, sound.error_to_percent);
  EXPECT_EQ(plots.plots[0].series[0].line.size(), 2U);
  // An error next to none is exact, and the ends of the range have axes.
  study.points = {point(Method::closed_form, "bike", 0, 10, 1e-300),
                  point(Method::closed_form, "bike", 2, least_time_ms, largest_error_percent / 100),
                  point(Method::closed_form, "bike", 4, largest_time_ms, 0.01)};
  const StudyPlots wide = plots_of(study);
  EXPECT_EQ(wide.out_of_range, 0);
  EXPECT_EQ(wide.plots[0].series[0].exact.size(), 1U);
  EXPECT_NEAR(wide.time_from_ms / least_time_ms, 1, 1e-9);
  EXPECT_NEAR(wide.time_to_ms / largest_time_ms, 1, 1e-9);
}

TEST(StudyPlots, DevicesHaveLinesOfTheirOwn) {
  Study study;
  study.points = {point(Method::closed_form, "bike", 2, 4, 0.03), point(Method::closed_form, "bike", 4, 8, 0.01),
                  point(Method::closed_form, "bike", 2, 0.1, 0.03)};
  study.points[2].device = "a GPU";
  const StudyPlots plots = plots_of(study);
  ASSERT_EQ(plots.plots[0].series.size(), 2U);
  EXPECT_EQ(plots.plots[0].series[0].line.size() + plots.plots[0].series[1].line.size(), 3U);
}

TEST(StudyPlots, AxesHoldADecadeAndWhatHasNoErrorNeedsNone) {
  Study study;
  study.points = {point(Method::closed_form, "bike", 0, 100, 0)};
  StudyPlots plots = plots_of(study);
  EXPECT_EQ(plots.time_from_ms, 100);
  EXPECT_EQ(plots.time_to_ms, 1000);
  EXPECT_LT(plots.error_from_percent, plots.error_to_percent);
  study.points.push_back(point(Method::far_field, "bike", 0, 300, 0.1));
  plots = plots_of(study);
  EXPECT_NEAR(plots.error_from_percent, 1, 1e-9);  // clear of the exact one at the lower edge
  EXPECT_NEAR(plots.error_to_percent, 10, 1e-9);
  EXPECT_TRUE(plots_of({}).plots.empty());
}

TEST(StudyPlots, TellsACostInTheMethodsOwnTerms) {
  EXPECT_EQ(cost_text(point(Method::closed_form, "", 4, 1, 1)), "T = 4");
  EXPECT_EQ(cost_text(point(Method::closed_form, "", 0, 1, 1)), "exact");
  EXPECT_EQ(cost_text(point(Method::position_dependent_printed, "", 200, 1, 1)), "K = 200");
  EXPECT_EQ(cost_text(point(Method::precomputed_lights, "", 4096, 1, 1)), "4096 lights");
  EXPECT_EQ(cost_text(point(Method::far_field, "", 0, 1, 1)), "");
}

}  // namespace
}  // namespace lumifield
