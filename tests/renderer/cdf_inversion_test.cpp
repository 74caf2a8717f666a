#include "renderer/sampling/cdf_inversion.h"

#include <gtest/gtest.h>
#include <random>
#include <vector>

namespace lumifield {
namespace {

std::vector<double> steep_cdf(int n, double power) {
  std::vector<double> cdf;
  for (int i = 0; i <= n; ++i) cdf.push_back(std::pow(double(i) / n, power));
  return cdf;
}

TEST(CdfInversion, BothWaysEndInThePieceThatHoldsTheValue) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> unit(0, 1);
  for (const double power : {0.05, 1.0, 3.0, 40.0}) {
    const std::vector<double> cdf = steep_cdf(300, power);
    for (int k = 0; k < 500; ++k) {
      const double y = unit(random);
      for (const auto inversion : {Inversion::secant, Inversion::bisection}) {
        const CdfBracket found = invert_cdf([&](int i) { return cdf[std::size_t(i)]; }, {0, 300, 0, 1}, y, inversion);
        EXPECT_LE(found.high - found.low, 1);
        EXPECT_LE(cdf[std::size_t(found.piece())], y);
        EXPECT_GE(cdf[std::size_t(found.piece() + 1)], y);
        EXPECT_LE(found.steps, inversion == Inversion::bisection ? 9 : 18) << power << ' ' << y;
      }
    }
  }
}

TEST(CdfInversion, TheSecantIsDoneAtOnceWhereTheFunctionIsALine) {
  const std::vector<double> cdf = steep_cdf(256, 1);
  const auto at = [&](int i) { return cdf[std::size_t(i)]; };
  EXPECT_EQ(invert_cdf(at, {0, 256, 0, 1}, 0.3, Inversion::secant).steps, 1);
  EXPECT_EQ(invert_cdf(at, {0, 256, 0, 1}, 0.3, Inversion::bisection).steps, 8);
  EXPECT_NEAR(invert_cdf(at, {0, 256, 0, 1}, 0.3, Inversion::secant, 0).position(0.3), 0.3 * 256, 1e-12);
}

TEST(CdfInversion, AtTheSameDepthTheSecantIsNearer) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> unit(0, 1);
  std::vector<double> cdf{0};
  for (int i = 0; i < 200; ++i) cdf.push_back(cdf.back() + 0.2 + unit(random));
  for (double& value : cdf) value /= cdf.back();
  const auto at = [&](int i) { return cdf[std::size_t(i)]; };
  double secant = 0, bisection = 0;
  for (int k = 0; k < 2000; ++k) {
    const double y = unit(random);
    const double exact = invert_cdf(at, {0, 200, 0, 1}, y, Inversion::bisection).position(y);
    secant += std::abs(invert_cdf(at, {0, 200, 0, 1}, y, Inversion::secant, 3).position(y) - exact);
    bisection += std::abs(invert_cdf(at, {0, 200, 0, 1}, y, Inversion::bisection, 3).position(y) - exact);
  }
  EXPECT_LT(secant, 0.5 * bisection);
}

TEST(CdfInversion, FlatPiecesAreSteppedOverAndFractionalEndsKept) {
  const std::vector<double> cdf{0, 0, 0, 1, 1, 3};
  const auto at = [&](int i) { return cdf[std::size_t(i)]; };
  EXPECT_EQ(invert_cdf(at, {0, 5, 0, 3}, 0, Inversion::secant).piece(), 2);
  EXPECT_EQ(invert_cdf(at, {0, 5, 0, 3}, 1, Inversion::secant).piece(), 4);
  const CdfBracket part = invert_cdf(at, {2.5, 2.75, 0.5, 0.75}, 0.6, Inversion::secant);
  EXPECT_EQ(part.steps, 0);
  EXPECT_NEAR(part.position(0.6), 2.6, 1e-12);
}

}  // namespace
}  // namespace lumifield
