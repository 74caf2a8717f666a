#include "acquisition/scan/lamp_stability.h"

#include <cmath>
#include <gtest/gtest.h>

namespace lumifield {
namespace {

constexpr Stabilisation wanted{0.01, 60, 600};

TEST(LampStability, TakesThreeReadingsAndTheWholeTime) {
  LampStability lamp(wanted);
  EXPECT_FALSE(lamp.spread());
  lamp.add(0, 100);
  EXPECT_FALSE(lamp.spread());
  lamp.add(60, 100);
  EXPECT_EQ(lamp.spread(), 0);
  EXPECT_FALSE(lamp.judges());
  EXPECT_FALSE(lamp.steady());
  lamp.add(61, 100);
  EXPECT_TRUE(lamp.steady());

  LampStability quick(wanted);
  for (int s = 0; s < 60; ++s) quick.add(s, 100);
  EXPECT_FALSE(quick.judges()) << "flat so far, but not for long enough to be called unsteady either";
  EXPECT_FALSE(quick.steady());
  quick.add(60, 100);
  EXPECT_TRUE(quick.steady());
}

TEST(LampStability, SpreadsByTheSmallestAndForgetsWhatIsOlder) {
  LampStability lamp(wanted);
  lamp.add(0, 102);
  for (int s = 10; s <= 60; s += 10) lamp.add(s, 100);
  EXPECT_NEAR(*lamp.spread(), 0.02, 1e-12);
  EXPECT_FALSE(lamp.steady());
  lamp.add(65, 101);  // the first still stands for the beginning of the last 60 s
  EXPECT_FALSE(lamp.steady());
  lamp.add(70, 101);
  EXPECT_NEAR(*lamp.spread(), 0.01, 1e-12);
  EXPECT_TRUE(lamp.steady());
}

TEST(LampStability, AnExponentialIsSteadyOnceItsLastStretchIsFlat) {
  LampStability lamp(wanted);
  double time_s = 0;
  for (; !lamp.steady(); time_s += 6) {
    ASSERT_LT(time_s, 600);
    lamp.add(time_s, 1 + 0.3 * std::exp(-time_s / 60));
  }
  // 0.3 exp(−t/60) (exp(1) − 1) = 0.01 · L(t)
  const double expected_s = 60 * std::log(0.3 * (std::exp(1) - 1.01) / 0.01);
  EXPECT_NEAR(time_s - 6, expected_s, 6);
  EXPECT_GE(time_s - 6, expected_s);
}

}  // namespace
}  // namespace lumifield
