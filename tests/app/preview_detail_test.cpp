#include "app/session/preview_detail.h"

#include <gtest/gtest.h>

namespace lumifield {
namespace {

constexpr double pixels = 1024 * 768;
constexpr PreviewDetail quarter{4, 4};

/// Costs as measured often: a second for a full picture of ten cells, a coarse pixel as dear as a fine one.
PreviewCosts costs_of_ten_cells_a_second() {
  PreviewCosts costs;
  for (int k = 0; k < 40; ++k) {
    for (const PreviewDetail detail : {PreviewDetail{}, quarter}) {
      const double share = detail.full() ? 1 : 1.0 / 16;
      costs.drawn(detail, pixels * share, 0);
      costs.shown(detail, pixels * share, 0);
      costs.summed(detail, pixels * share, 10, 1 * share);
    }
  }
  return costs;
}

TEST(PreviewCosts, AreThoseMeasured) {
  PreviewCosts costs = costs_of_ten_cells_a_second();
  EXPECT_NEAR(costs.picture_s({}, pixels, 10), 1, 1e-6);
  EXPECT_NEAR(costs.cell_s({}, pixels), 0.1, 1e-6);
  EXPECT_NEAR(costs.picture_s(quarter, pixels / 16, 20), 2.0 / 16, 1e-6);
  for (int k = 0; k < 40; ++k) {
    costs.drawn({}, pixels, 0.3);
    costs.shown({}, pixels, 0.1);
  }
  EXPECT_NEAR(costs.picture_s({}, pixels, 10), 1.4, 1e-6);
  EXPECT_NEAR(costs.picture_s(quarter, pixels / 16, 10), 1.0 / 16, 1e-6) << "coarse ones have costs of their own";

  // Nothing made teaches nothing.
  costs.summed({}, pixels, 0, 5);
  EXPECT_NEAR(costs.cell_s({}, pixels), 0.1, 1e-6);
}

TEST(PreviewCosts, TheFinestThatFitsIsChosen) {
  const PreviewCosts costs = costs_of_ten_cells_a_second();
  EXPECT_TRUE(costs.finest_within(1.01, pixels, 10, {}).full());
  EXPECT_EQ(costs.finest_within(0.3, pixels, 10, {}).divisor, 2);
  EXPECT_EQ(costs.finest_within(0.05, pixels, 10, {}).divisor, 6);
  EXPECT_GT(costs.finest_within(0.05, pixels, 10, {}).lod, 0);
  EXPECT_EQ(costs.finest_within(0, pixels, 10, {}).divisor, 16) << "the coarsest where none fits";
  EXPECT_TRUE(costs.finest_within(0.05, pixels, 0, {}).full());
}

TEST(PreviewCosts, WhatNearlyFitsIsKept) {
  const PreviewCosts costs = costs_of_ten_cells_a_second();
  EXPECT_EQ(costs.finest_within(0.06, pixels, 10, quarter), quarter) << "1/16 s is a little more";
  EXPECT_EQ(costs.finest_within(0.15, pixels, 10, quarter), quarter) << "a third would fit";
  EXPECT_EQ(costs.finest_within(0.04, pixels, 10, quarter).divisor, 6);
  EXPECT_EQ(costs.finest_within(0.3, pixels, 10, quarter).divisor, 2);
}

TEST(PreviewCosts, OnlyManyCellsAreShownCoarselyFirst) {
  EXPECT_TRUE(shows_coarsely_first(98, 99, 0.04)) << "a dataset that is opened";
  EXPECT_FALSE(shows_coarsely_first(8, 99, 0.04)) << "soon added";
  EXPECT_FALSE(shows_coarsely_first(1, 60, 5)) << "a scan's cell on a slow machine";
  EXPECT_FALSE(shows_coarsely_first(1, 1, 5));
  EXPECT_FALSE(shows_coarsely_first(20, 60, 5)) << "the full picture would lose forty";
  EXPECT_TRUE(shows_coarsely_first(30, 60, 5));
}

}  // namespace
}  // namespace lumifield
