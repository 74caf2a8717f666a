#include "app/session/preview_detail.h"

#include <algorithm>
#include <gtest/gtest.h>
#include <random>
#include <set>

namespace lumifield {
namespace {

constexpr double pixels = 1024 * 768;
constexpr PreviewDetail quarter{4, 8};

/// Costs as measured often: a second for a full picture of ten cells, of it a tenth for drawing and showing; a coarse
/// pixel as dear as a fine one.
PreviewCosts costs_of_ten_cells_a_second() {
  PreviewCosts costs;
  for (int k = 0; k < 60; ++k) {
    for (const PreviewDetail detail : {PreviewDetail{}, quarter, PreviewDetail{16, 8}}) {
      const double share = 1.0 / (detail.divisor * detail.divisor);
      costs.drawn(detail, pixels * share, 0.05 * share);
      costs.shown(detail, pixels * share, 0.05 * share);
      costs.summed(detail, pixels * share, 10, 0.9 * share);
    }
  }
  return costs;
}

TEST(PreviewCosts, AreThoseMeasured) {
  PreviewCosts costs = costs_of_ten_cells_a_second();
  EXPECT_NEAR(costs.picture_s({}, pixels, 10), 1, 1e-6);
  EXPECT_NEAR(costs.cell_s({}, pixels), 0.09, 1e-6);
  EXPECT_NEAR(costs.picture_s(quarter, pixels / 16, 20), 1.9 / 16, 1e-3);
  for (int k = 0; k < 40; ++k) {
    costs.drawn({}, pixels, 0.3);
    costs.shown({}, pixels, 0.1);
  }
  EXPECT_NEAR(costs.picture_s({}, pixels, 10), 1.3, 1e-6);
  EXPECT_NEAR(costs.picture_s(quarter, pixels / 16, 10), 1.0 / 16, 1e-3) << "coarse ones have costs of their own";

  // Nothing made teaches nothing.
  costs.summed({}, pixels, 0, 5);
  EXPECT_NEAR(costs.cell_s({}, pixels), 0.09, 1e-6);
}

TEST(PreviewCosts, TheFinestThatFitsIsChosen) {
  const PreviewCosts costs = costs_of_ten_cells_a_second();
  EXPECT_TRUE(costs.finest_within(1.01, pixels, 10, {}).full());
  EXPECT_EQ(costs.finest_within(0.3, pixels, 10, {}).divisor, 2);
  EXPECT_EQ(costs.finest_within(0.03, pixels, 10, {}).divisor, 6);
  EXPECT_GT(costs.finest_within(0.05, pixels, 10, {}).lod, 0);
  EXPECT_EQ(costs.finest_within(0, pixels, 10, {}).divisor, 16) << "the coarsest where none fits";
  EXPECT_TRUE(costs.finest_within(0.11, pixels, 0, {}).full());
}

TEST(PreviewCosts, WhatNearlyFitsIsKept) {
  const PreviewCosts costs = costs_of_ten_cells_a_second();
  EXPECT_EQ(costs.finest_within(0.06, pixels, 10, quarter), quarter) << "1/16 s is a little more";
  EXPECT_EQ(costs.finest_within(0.12, pixels, 10, quarter), quarter) << "a third would just fit";
  EXPECT_EQ(costs.finest_within(0.16, pixels, 10, quarter).divisor, 3) << "a third fits well";
  EXPECT_EQ(costs.finest_within(0.042, pixels, 10, quarter).divisor, 5);
  EXPECT_EQ(costs.finest_within(0.35, pixels, 10, quarter).divisor, 2);
}

/// A machine on which coarse pictures have a fixed part, and times scatter.
class CoarsePictures {
 public:
  explicit CoarsePictures(double busy) : busy_(busy) {}
  double make(PreviewCosts& costs, PreviewDetail detail, int cells) {
    const double share = 1.0 / (detail.divisor * detail.divisor), scatter = busy_ * uniform_(random_);
    const double draw_s = (0.0015 + 0.03 * share) * scatter, show_s = 0.01 * share * scatter;
    const double cell_s = (0.0003 + 0.01 * share) * scatter;
    costs.drawn(detail, pixels * share, draw_s);
    costs.summed(detail, pixels * share, cells, cells * cell_s);
    costs.shown(detail, pixels * share, show_s);
    return draw_s + cells * cell_s + show_s;
  }

 private:
  double busy_;
  std::mt19937 random_{3};
  std::uniform_real_distribution<double> uniform_{0.9, 1.1};
};

TEST(PreviewCosts, SettleAtTheFinestThatFitsInSpiteOfAFixedPart) {
  for (const double busy : {0.3, 1.0, 2.0}) {
    PreviewCosts costs;
    CoarsePictures machine(busy);
    PreviewDetail detail{16, 8};
    std::set<int> settled;
    double longest_s = 0;
    for (int k = 0; k < 200; ++k) {
      detail = costs.finest_within(0.055, pixels, 63, detail);
      const double took_s = machine.make(costs, detail, 63);
      if (k < 40) continue;
      settled.insert(detail.divisor);
      longest_s = std::max(longest_s, took_s);
    }
    EXPECT_EQ(settled.size(), 1U) << "it flickers, busy " << busy;
    EXPECT_LT(longest_s, 0.055 * 1.2 * 1.1);
    EXPECT_GT(longest_s, 0.055 / 2.5) << "finer would do, busy " << busy;
  }
}

TEST(PreviewCosts, OnlyManyCellsAreShownCoarselyFirst) {
  EXPECT_TRUE(shows_coarsely_first(98, 99, 0.04)) << "a dataset that is opened";
  EXPECT_FALSE(shows_coarsely_first(8, 99, 0.04)) << "soon added";
  EXPECT_FALSE(shows_coarsely_first(1, 60, 5)) << "a scan's cell on a slow machine";
  EXPECT_FALSE(shows_coarsely_first(1, 1, 5));
  EXPECT_FALSE(shows_coarsely_first(20, 60, 5)) << "the full picture would lose forty";
  EXPECT_TRUE(shows_coarsely_first(30, 60, 5));
}

TEST(PreviewCosts, OfAFullPictureAreThoseOfCoarseOnesUntilOneIsMade) {
  PreviewCosts costs;
  EXPECT_FALSE(costs.known());
  for (int k = 0; k < 20; ++k) costs.summed(coarsest(), pixels / 256, 1, 0.1);
  EXPECT_TRUE(costs.known());
  EXPECT_GT(costs.cell_s({}, pixels), 0.1) << "as dear as the coarse ones at the least";
  for (int k = 0; k < 20; ++k) costs.summed({}, pixels, 1, 0.05);
  EXPECT_NEAR(costs.cell_s({}, pixels), 0.05, 0.01);
}

TEST(PreviewCosts, CellsThatAreComputedTogetherAreShownCoarselyFirstWhereTheyTakeLong) {
  EXPECT_TRUE(shows_all_coarsely_first(1, 1, 5)) << "the first";
  EXPECT_TRUE(shows_all_coarsely_first(30, 60, 5)) << "the full picture has half of them";
  EXPECT_FALSE(shows_all_coarsely_first(20, 60, 5)) << "the next full one follows a full one";
  EXPECT_FALSE(shows_all_coarsely_first(60, 60, 0.005));
}

}  // namespace
}  // namespace lumifield
