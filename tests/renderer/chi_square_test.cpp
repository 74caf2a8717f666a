#include "tests/support/chi_square.h"

#include <cmath>
#include <gtest/gtest.h>
#include <random>
#include <vector>

namespace lumifield {
namespace {

/// The unit square, drawn evenly but for a share that is not drawn, against the even density.
ChiSquare even(double missed) {
  return chi_square_2d(
      {0, 1, 0, 1, 8, 8}, 20000, 3,
      [&](double xi1, double xi2, double& x, double& y) {
        x = xi1, y = xi2;
        return std::fmod(1000 * xi1, 1.0) >= missed;
      },
      [](double, double) { return 1.0; });
}

TEST(ChiSquare, SeesWhatIsNotDrawn) {
  EXPECT_TRUE(even(0).plausible()) << even(0).text();
  EXPECT_FALSE(even(0.1).plausible()) << even(0.1).text();
  EXPECT_FALSE(even(1).plausible()) << even(1).text();
}

TEST(ChiSquare, SaysNothingOfNothing) {
  const std::vector<double> none(12, 0.0), some(12, 100.0);
  EXPECT_FALSE(chi_square(none, none).plausible());
  EXPECT_FALSE(chi_square({}, {}).plausible());
  EXPECT_FALSE(chi_square(none, some).plausible());
  EXPECT_FALSE(chi_square(some, none).plausible()) << "what is impossible";
  EXPECT_TRUE(chi_square(some, some).plausible());
}

TEST(ChiSquare, PassesItsBoundAsSeldomAsItSays) {
  // 3,000 tests of a fair die: about a tenth of one passes.
  std::mt19937 random(4);
  const std::vector<double> expected(6, 100.0);
  int passed = 0;
  for (int test = 0; test < 3000; ++test) {
    std::vector<double> counts(6, 0.0);
    for (int k = 0; k < 600; ++k) counts[random() % 6] += 1;
    passed += !chi_square(counts, expected).plausible();
    counts[0] += 60, counts[1] -= 60;
    EXPECT_FALSE(chi_square(counts, expected).plausible());
  }
  EXPECT_LE(passed, 2);
}

}  // namespace
}  // namespace lumifield
