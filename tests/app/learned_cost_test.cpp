#include "app/session/learned_cost.h"

#include <gtest/gtest.h>

namespace lumifield {
namespace {

constexpr double small = 3000, large = 50000;

TEST(LearnedCost, StartsAsExpected) {
  const LearnedCost cost(0.002, 1e-6);
  EXPECT_DOUBLE_EQ(cost.seconds(0), 0.002);
  EXPECT_DOUBLE_EQ(cost.seconds(1000), 0.003);
}

TEST(LearnedCost, TellsTheFixedPartFromTheRate) {
  LearnedCost cost(1e-3, 1e-7);
  const auto truth = [](double amount) { return 0.02 + 4e-7 * amount; };
  for (int k = 0; k < 60; ++k) {
    cost.learn(small, truth(small));
    cost.learn(large, truth(large));
  }
  for (const double amount : {0.0, small, large, 16 * large})
    EXPECT_NEAR(cost.seconds(amount), truth(amount), 1e-6 * truth(amount));
}

TEST(LearnedCost, OneAmountAloneIsNoLaterThanInProportion) {
  LearnedCost cost(1e-3, 1e-7);
  for (int k = 0; k < 60; ++k) cost.learn(small, 0.02);
  EXPECT_NEAR(cost.seconds(small), 0.02, 1e-9);
  EXPECT_GE(cost.seconds(large), 0.02);
  EXPECT_LE(cost.seconds(large), 0.02 * large / small);
}

TEST(LearnedCost, FollowsABusyMachineWithinAFewPieces) {
  LearnedCost cost(0.01, 1e-6);
  for (int k = 0; k < 60; ++k) cost.learn(small, 0.013);
  for (int k = 0; k < 5; ++k) cost.learn(small, 0.026);
  EXPECT_GT(cost.seconds(small), 0.022);
  for (int k = 0; k < 5; ++k) cost.learn(small, 0.013);
  EXPECT_LT(cost.seconds(small), 0.015);
}

TEST(LearnedCost, ALoneDisturbanceDoesNotCountForLong) {
  LearnedCost cost(0.01, 1e-6);
  for (int k = 0; k < 60; ++k) cost.learn(small, 0.013);
  cost.learn(small, 3600);
  EXPECT_LT(cost.seconds(small), 3 * 0.013);
  for (int k = 0; k < 8; ++k) cost.learn(small, 0.013);
  EXPECT_LT(cost.seconds(small), 0.015);
}

TEST(LearnedCost, WhatTookNoTimeCanGrowAgain) {
  LearnedCost cost(0.01, 1e-6);
  for (int k = 0; k < 1000; ++k) cost.learn(small, 0);
  EXPECT_LT(cost.seconds(small), 1e-4);
  for (int k = 0; k < 40; ++k) cost.learn(small, 0.02);
  EXPECT_NEAR(cost.seconds(small), 0.02, 0.002);
}

}  // namespace
}  // namespace lumifield
