#include "renderer/sampling/sample_counts.h"

#include <cmath>
#include <gtest/gtest.h>
#include <numeric>

namespace lumifield {
namespace {

const std::vector<double> a{0, 1, 2.5, 0.01, 40, 0, 3};

TEST(SampleCounts, ExpectedCountsShareK) {
  const auto kappa = expected_counts(a, 50);
  EXPECT_NEAR(std::accumulate(kappa.begin(), kappa.end(), 0.0), 50, 1e-12);
  EXPECT_NEAR(kappa[2], 50 * 2.5 / 46.51, 1e-12);
  EXPECT_EQ(kappa[0], 0);
}

TEST(SampleCounts, KMaxActsOnTheExpectedCount) {
  const auto kappa = expected_counts(a, 50, 7);
  EXPECT_EQ(kappa[4], 7);
  EXPECT_NEAR(kappa[6], 50 * 3 / 46.51, 1e-12) << "the others keep theirs";
}

TEST(SampleCounts, NoLightNoSamples) {
  const auto kappa = expected_counts(std::vector<double>{0, 0, 0}, 50);
  EXPECT_EQ(kappa, (std::vector<double>{0, 0, 0}));
  EXPECT_TRUE(expected_counts({}, 50).empty());
}

TEST(SampleCounts, SystematicRoundingHasTheExpectedMeanOfEveryCell) {
  for (const double k : {3.0, 50.0}) {
    const auto kappa = expected_counts(a, k, 7);
    std::vector<double> mean(a.size());
    constexpr int n = 100000;
    for (int i = 0; i < n; ++i) {
      const auto counts = systematic_rounding(kappa, (i + 0.5) / n);
      for (std::size_t m = 0; m < a.size(); ++m) {
        EXPECT_LE(std::abs(counts[m] - kappa[m]), 1 + 1e-9);
        mean[m] += counts[m] / double(n);
      }
      const int all = std::accumulate(counts.begin(), counts.end(), 0);
      EXPECT_LE(std::abs(all - std::accumulate(kappa.begin(), kappa.end(), 0.0)), 1 + 1e-9);
    }
    for (std::size_t m = 0; m < a.size(); ++m) EXPECT_NEAR(mean[m], kappa[m], 1e-4) << m;
  }
}

TEST(SampleCounts, NearestCountsDropFaintCells) {
  const auto counts = nearest_counts(expected_counts(a, 50));
  EXPECT_EQ(counts[3], 0);
  EXPECT_EQ(counts[4], 43);
}

}  // namespace
}  // namespace lumifield
