#include "renderer/sampling/sequence.h"

#include <cmath>
#include <gtest/gtest.h>

#include "tests/support/chi_square.h"

namespace lumifield {
namespace {

TEST(Sequence, RadicalInversesMirrorDigits) {
  EXPECT_DOUBLE_EQ(radical_inverse(2, 6), 0.375);    // 110 → 0.011
  EXPECT_DOUBLE_EQ(radical_inverse(3, 5), 7.0 / 9);  // 12 → 0.21
  EXPECT_EQ(radical_inverse(2, 0), 0);
}

/// Σ over a grid of anchored boxes: the largest difference of share and area.
double discrepancy(const std::vector<UnitPoint>& points) {
  double worst = 0;
  for (int a = 1; a <= 32; ++a)
    for (int b = 1; b <= 32; ++b) {
      double in = 0;
      for (const UnitPoint p : points) in += p.x < a / 32.0 && p.y < b / 32.0;
      worst = std::max(worst, std::abs(in / double(points.size()) - a * b / 1024.0));
    }
  return worst;
}

TEST(Sequence, HaltonIsSpreadBetterThanIndependentNumbers) {
  for (const int n : {50, 200, 1000}) {
    const auto halton = halton_points(n);
    double twister = 0;
    for (unsigned seed = 0; seed < 20; ++seed) twister += discrepancy(twister_points(n, seed)) / 20;
    EXPECT_LT(discrepancy(halton), 0.7 * twister) << n;
    // 2.5 log²(n)/n holds for every prefix of bases 2 and 3 here.
    EXPECT_LT(discrepancy(halton), 2.5 * std::log(n) * std::log(n) / n) << n;
  }
}

TEST(Sequence, PointsLieInTheHalfOpenSquare) {
  for (const auto& points : {halton_points(5000), twister_points(5000, 3)})
    for (const UnitPoint p : points) {
      ASSERT_TRUE(p.x >= 0 && p.x < 1 && p.y >= 0 && p.y < 1);
      const UnitPoint moved = rotated(p, {0.99999994f, 0.5f});
      ASSERT_TRUE(moved.x >= 0 && moved.x < 1 && moved.y >= 0 && moved.y < 1);
    }
}

TEST(Sequence, ShiftsAndOffsetsAreUniformOverSeeds) {
  std::vector<double> x(16), y(16), offset(16), even(16, 4000.0 / 16);
  for (std::uint32_t seed = 0; seed < 4000; ++seed) {
    x[std::size_t(16 * cell_shift(seed, 7).x)] += 1;
    y[std::size_t(16 * cell_shift(seed, 7).y)] += 1;
    offset[std::size_t(16 * rounding_offset(seed, 123456))] += 1;
  }
  for (const auto& counts : {x, y, offset}) {
    const ChiSquare test = chi_square(counts, even);
    EXPECT_TRUE(test.plausible()) << test.text();
  }
}

TEST(Sequence, CellsAndReceiversOfTheTwisterAreIndependent) {
  const PointSet twister(PointSequence::twister, 10, 1), halton(PointSequence::halton, 10, 1);
  EXPECT_NE(twister.at(3, 5, 0).x, twister.at(3, 6, 0).x);
  EXPECT_EQ(halton.at(3, 5, 7).x, halton.at(3, 6, 7).x) << "all receivers share the sequence";
  EXPECT_NE(halton.at(3, 5, 7).x, halton.at(4, 5, 7).x) << "each cell has its own rotation";
}

TEST(Sequence, TheTwisterDoesNotRepeatWithinACellAndReceiver) {
  const int most = 100'000;
  const PointSet twister(PointSequence::twister, most, 1);
  int the_same = 0;
  const UnitPoint first = twister.at(3, 5, 0);
  for (int k = 1; k <= most; ++k) the_same += twister.at(3, 5, k).x == first.x && twister.at(3, 5, k).y == first.y;
  EXPECT_EQ(the_same, 0);
}

TEST(Sequence, TheTwisterIsSeeded) {
  const auto a = twister_points(10, 5), b = twister_points(10, 5), c = twister_points(10, 6);
  EXPECT_EQ(a[9].x, b[9].x);
  EXPECT_NE(a[9].x, c[9].x);
}

}  // namespace
}  // namespace lumifield
