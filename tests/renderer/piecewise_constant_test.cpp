#include <gtest/gtest.h>
#include <numeric>
#include <random>

#include "renderer/sampling/piecewise_constant_2d.h"
#include "tests/support/chi_square.h"

namespace lumifield {
namespace {

const std::vector<double> f{0, 3, 0.5, 0, 0, 2, 1e-3, 7, 0};

TEST(PiecewiseConstant1D, IntegralsAreThoseOfItsPieces) {
  const PiecewiseConstant1D one(f);
  EXPECT_DOUBLE_EQ(one.integral(), 12.501);
  EXPECT_DOUBLE_EQ(one.integral(1.25, 2.5), 0.75 * 3 + 0.5 * 0.5);
  EXPECT_DOUBLE_EQ(one.integral(5.25, 5.75), 1);
  EXPECT_DOUBLE_EQ(one.integral(-3, 20), 12.501) << "nothing outside";
  EXPECT_EQ(one.integral(3, 5), 0);
}

TEST(PiecewiseConstant1D, TheRestrictedDensityIntegratesToOne) {
  const PiecewiseConstant1D one(f);
  for (const auto& [a, b] : {std::pair(0.0, 9.0), {1.3, 7.9}, {5.2, 5.4}, {-2.0, 2.5}}) {
    double sum = 0;
    constexpr int n = 200000;
    for (int k = 0; k < n; ++k) sum += one.pdf(a + (k + 0.5) * (b - a) / n, a, b) * (b - a) / n;
    EXPECT_NEAR(sum, 1, 1e-4) << a << " … " << b;
  }
  EXPECT_EQ(one.pdf(3.5, 3, 5), 0);
  EXPECT_EQ(one.pdf(1.5, 2, 9), 0) << "outside the interval";
}

TEST(PiecewiseConstant1D, SamplingAndInvertingAreEachOthersInverse) {
  const PiecewiseConstant1D one(f);
  for (const auto inversion : {Inversion::secant, Inversion::bisection})
    for (double xi = 0; xi < 1; xi += 1.0 / 512) {
      const auto x = one.sample(xi, 1.25, 8.5, inversion);
      ASSERT_TRUE(x);
      EXPECT_GT(one(*x), 0) << "never where there is nothing";
      EXPECT_NEAR(one.invert(*x, 1.25, 8.5), xi, 1e-14);
    }
}

TEST(PiecewiseConstant1D, NothingToSampleIsEmpty) {
  EXPECT_FALSE(PiecewiseConstant1D(f).sample(0.5, 3, 5));
  EXPECT_FALSE(PiecewiseConstant1D(f).sample(0.5, 20, 25));
  EXPECT_FALSE(PiecewiseConstant1D(std::vector<double>(5, 0.0)).sample(0.5, 0, 5));
  EXPECT_FALSE(PiecewiseConstant1D().sample(0.5, 0, 1));
}

TEST(PiecewiseConstant1D, AnEstimateWeighedByTheDensityMeetsTheIntegral) {
  // ∫ x² f over [1.25, 8.5] piece by piece.
  double wanted = 0;
  for (std::size_t i = 0; i < f.size(); ++i) {
    const double a = std::max(1.25, double(i)), b = std::min(8.5, double(i) + 1);
    if (b > a) wanted += f[i] * (b * b * b - a * a * a) / 3;
  }
  const PiecewiseConstant1D one(f);
  double sum = 0;
  // Each gap in f costs at most its jump in x²/n.
  constexpr int n = 200000;
  for (int k = 0; k < n; ++k) {
    const double x = *one.sample((k + 0.5) / n, 1.25, 8.5);
    sum += x * x * one(x) / one.pdf(x, 1.25, 8.5) / n;
  }
  EXPECT_NEAR(sum, wanted, 1e-4 * wanted);
}

SummedAreaTable random_image(int width, int height, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(-0.3, 1);
  std::vector<double> image;
  for (int k = 0; k < width * height; ++k) image.push_back(std::max(unit(random), 0.0));
  return {image, width, height};
}

TEST(PiecewiseConstant2D, TheWholeImageIsDrawnByItsDensity) {
  const SummedAreaTable image = random_image(12, 9, 1);
  const PiecewiseConstant2D two(image);
  EXPECT_NEAR(two.integral(), image.total(), 1e-12);
  const ChiSquare test = chi_square_2d(
      {0, 12, 0, 9, 12, 9}, 40000, 2,
      [&](double xi1, double xi2, double& x, double& y) {
        const auto point = two.sample(xi1, xi2, two.whole());
        if (!point) return false;
        EXPECT_EQ(point->i, int(point->x));
        EXPECT_EQ(point->j, int(point->y));
        x = point->x, y = point->y;
        return true;
      },
      [&](double x, double y) { return image.value(int(x), int(y)) / image.total(); });
  EXPECT_TRUE(test.plausible()) << test.text();
}

TEST(PiecewiseConstant2D, ThePrintedRestrictionIsDrawnByItsOwnDensityNotTheImages) {
  // Columns with different shares of their light inside the box.
  const SummedAreaTable image = random_image(12, 9, 3);
  const PiecewiseConstant2D two(image);
  const PixelBox box{2.5, 9.25, 1.75, 5.5};
  const auto sample = [&](double xi1, double xi2, double& x, double& y) {
    const auto point = two.sample(xi1, xi2, box);
    if (!point) return false;
    x = point->x, y = point->y;
    return true;
  };
  const ChiSquareGrid grid{2.5, 9.25, 1.75, 5.5, 27, 15};
  const ChiSquare own = chi_square_2d(grid, 60000, 4, sample, [&](double x, double y) { return two.pdf(x, y, box); });
  EXPECT_TRUE(own.plausible()) << own.text();
  const double all = image.integral(box);
  const ChiSquare exact =
      chi_square_2d(grid, 60000, 4, sample, [&](double x, double y) { return image.value(int(x), int(y)) / all; });
  EXPECT_GT(exact.statistic, 3 * exact.bound()) << "the published pair is not the image's density in the box";
}

TEST(PiecewiseConstant2D, InvertingUndoesSampling) {
  const PiecewiseConstant2D two(random_image(7, 11, 5));
  const PixelBox box{0.5, 6.25, 2.5, 10};
  for (double xi1 = 0.01; xi1 < 1; xi1 += 0.07)
    for (double xi2 = 0.02; xi2 < 1; xi2 += 0.07) {
      const auto point = two.sample(xi1, xi2, box);
      ASSERT_TRUE(point);
      const auto unit = two.invert(point->x, point->y, box);
      EXPECT_NEAR(unit.xi1, xi1, 1e-13);
      EXPECT_NEAR(unit.xi2, xi2, 1e-13);
    }
}

}  // namespace
}  // namespace lumifield
