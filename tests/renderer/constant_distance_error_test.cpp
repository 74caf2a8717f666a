#include "renderer/shift_invariant/constant_distance_error.h"

#include <cmath>
#include <gtest/gtest.h>
#include <numbers>

namespace lumifield {
namespace {

constexpr double pi = std::numbers::pi;

struct Maximum {
  double error = 0, at_rad = 0;
};
Maximum maximum_over_theta(double s, double azimuth) {
  Maximum found;
  for (int k = 0; k < 89000; ++k) {
    const double theta = k * pi / 180000;
    const double error = constant_distance_error(s / 2, theta, azimuth);
    if (error > found.error) found = {error, theta};
  }
  return found;
}

/// By the definition, over 201×201 points of the support.
double by_points(double half, double theta, double azimuth) {
  double least = HUGE_VAL, most = 0;
  const double off = std::tan(theta);
  for (int k = 0; k <= 200; ++k)
    for (int i = 0; i <= 200; ++i) {
      const double x = off * std::cos(azimuth) + half * (i - 100) / 100,
                   y = off * std::sin(azimuth) + half * (k - 100) / 100;
      const double cos4 = std::pow(1 / std::sqrt(1 + x * x + y * y), 4);
      least = std::min(least, cos4);
      most = std::max(most, cos4);
    }
  return (most - least) / std::pow(std::cos(theta), 4);
}

TEST(ConstantDistanceError, IsTheDefinition) {
  for (const double half : {0.005, 0.02, 0.3})
    for (const double theta : {0.0, 0.1, 0.7, 1.3})
      for (const double azimuth : {0.0, 0.4, pi / 4, 2.0, -1.1})
        EXPECT_NEAR(constant_distance_error(half, theta, azimuth), by_points(half, theta, azimuth),
                    3e-5 * by_points(half, theta, azimuth))
            << half << ", " << theta << ", " << azimuth;
}

TEST(ConstantDistanceError, IsAtMostWhatThePaperSays) {
  const Maximum axis = maximum_over_theta(0.04, 0), diagonal = maximum_over_theta(0.04, pi / 4);
  EXPECT_NEAR(axis.error, 0.080, 5e-4);
  EXPECT_NEAR(axis.at_rad, pi / 4, 0.02);
  EXPECT_NEAR(diagonal.error, 0.113, 5e-4);
  // 2s along an axis and 2√2 s across the diagonal, to first order.
  for (const double s : {0.001, 0.01}) {
    EXPECT_NEAR(maximum_over_theta(s, 0).error / (2 * s), 1, 3 * s);
    EXPECT_NEAR(maximum_over_theta(s, pi / 4).error / (2 * std::numbers::sqrt2 * s), 1, 3 * s);
  }
}

TEST(ConstantDistanceError, IsAlikeOnAllSidesAndNoneOfAPoint) {
  EXPECT_EQ(constant_distance_error(0, 1, 0.3), 0);
  for (const double azimuth : {0.3, 1.1})
    for (const double turned : {-azimuth, azimuth + pi, pi / 2 - azimuth})
      EXPECT_NEAR(constant_distance_error(0.05, 0.8, turned), constant_distance_error(0.05, 0.8, azimuth), 1e-14);
}

TEST(ConstantDistanceError, OfACellIsTheLargestOverItsImage) {
  // A box of 6 mm at δ = 150 mm, s = 0.04, seen to both sides by 45° and more along x alone.
  LuminaireGeometry geometry;
  geometry.planes.separation_mm = 150;
  geometry.sampling = {BasisKind::box, {6, 6}, 1, 1, {0, 0}};
  geometry.measurement = {400, 1, {1, 1e-6}, {0, 0}};
  EXPECT_NEAR(largest_constant_distance_error(geometry, {0, 0}), 0.080, 1e-3);
  // Only as far as the image goes: straight on there is next to none.
  geometry.measurement = {1, 1, {1e-6, 1e-6}, {0, 0}};
  EXPECT_NEAR(largest_constant_distance_error(geometry, {0, 0}), constant_distance_error(0.02, 0, 0), 1e-6);
  // The image that a cell at the rim of the grid has is seen from there, and the longer side of the support counts.
  geometry.sampling = {BasisKind::box, {6, 3}, 2, 1, {0, 0}};
  geometry.measurement = {100, 1, {1, 1e-6}, {53, 0}};
  EXPECT_GT(largest_constant_distance_error(geometry, {0, 0}), largest_constant_distance_error(geometry, {0, 1}));
}

}  // namespace
}  // namespace lumifield
