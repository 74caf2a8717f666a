#include <Eigen/LU>
#include <cmath>
#include <gtest/gtest.h>
#include <random>

#include "acquisition/virtual/screen.h"
#include "acquisition/virtual/world.h"

namespace lumifield::virtual_bench {
namespace {

/// The definition by the midpoint rule over the exit, cosines and distances written out. G band.
double definition(const Lamp& lamp, const TruthPoint& at) {
  const int nx = 720, ny = 440;
  double sum = 0;
  for (int j = 0; j < ny; ++j)
    for (int i = 0; i < nx; ++i) {
      const Vec3 u((i + 0.5) / nx * 36 - 18, (j + 0.5) / ny * 22 - 11, 0), ray = at.p_mm - u;
      const double incident = -at.n.dot(ray);
      if (incident <= 0) continue;
      const double distance = ray.norm();
      sum += lamp.radiance(u.head<2>(), ray.head<2>() / ray.z())[1] * (ray.z() / distance) * incident /
             std::pow(distance, 3);
    }
  return sum * (36.0 / nx) * (22.0 / ny);
}

std::vector<TruthPoint> receivers() {
  return {{{0, 0, 150}, {0, 0, -1}},
          {{60, -80, 420}, Vec3(0.3, 0.2, -1).normalized()},
          {{-900, 400, 3000}, Vec3(0, -0.4, -1).normalized()},
          {{5, 3, 40}, {0, 0, -1}},                      // between the planes
          {{6, -2, 300}, Vec3(1, 0.4, 0).normalized()},  // the horizon cuts the lamp
          {{3, 1, 200}, Vec3(0, -1, 0)},                 // and along an axis
          {{40, 20, 250}, Vec3(0.98, -0.1, -0.12).normalized()},
          {{0, 0, 150}, {0, 0, 1}}};  // turned away
}

class TruthOfLamp : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Lamps, TruthOfLamp, testing::Values("bike", "headlight", "led-array"), [](const auto& tested) {
  std::string name = tested.param;
  std::erase(name, '-');
  return name;
});

TEST_P(TruthOfLamp, IsTheDefinition) {
  WorldOptions options;
  options.lamp = GetParam();
  const Lamp lamp = *make_lamp(GetParam());
  const auto points = receivers();
  const auto values = truth(options, false, points);
  ASSERT_EQ(values.size(), points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double expected = definition(lamp, points[i]);
    EXPECT_NEAR(values[i].g, expected, 2e-4 * expected) << "receiver " << i;
    EXPECT_NEAR(values[i].y, 0.25 * values[i].r + 0.60 * values[i].g + 0.15 * values[i].b, 1e-9 * values[i].y);
  }
}

TEST(Truth, IsZeroBehindTheLamp) {
  const std::vector<TruthPoint> points{{{0, 0, 0}, {0, 0, -1}}, {{3, 2, -50}, {0, 0, 1}}};
  for (bool projected : {false, true})
    for (const TruthValue& value : truth({}, projected, points)) EXPECT_EQ(value.y, 0);
}

TEST(Truth, RefusesWhatTheWorldRefuses) {
  WorldOptions options;
  options.lamp = "candle";
  EXPECT_TRUE(truth(options, false, receivers()).empty());
}

/// E of the luminaire whose C_m are the combined screen images of a whole scan, from the reconstruction
/// L = Σ C_m(s) Φ_m(u) δ²/cos⁴θ by the midpoint rule. G band; images at the nodes of a grid, bilinear between.
class Scan {
 public:
  Scan(const WorldOptions& options, double step_mm, const TruthGrid& cells)
      : basis_(options.basis), a_(options.spacing_mm.x()), grid_(ScreenGrid::covering(Vec2(150, 100), step_mm)) {
    const auto world = World::create(options);
    const Bench& bench = (*world)->bench();
    const Lamp lamp = *make_lamp(options.lamp);
    const Slide slide(bench.filter);
    columns_ = cells.columns > 0 ? cells.columns : cells_needed(36, a_, options.window);
    rows_ = cells.rows > 0 ? cells.rows : cells_needed(22, a_, options.window);
    for (int cell = 0; cell < rows_ * columns_; ++cell) {
      images_.push_back(Plane::Zero(grid_.rows, grid_.columns));
      for (const FilterPass& pass : bench.filter.passes) {
        const Vec2 q = bench.stage_to_luminaire.linear.inverse() * (center(cell) - bench.stage_to_luminaire.origin_mm);
        images_.back() += static_cast<float>(pass.scale / (a_ * a_)) *
                          screen_irradiance(lamp, slide, bench, grid_, q + pass.offset_mm, {{0, 1, 0}})[0];
      }
    }
  }

  /// E, and the integral of the absolute integrand.
  std::pair<double, double> irradiance(const TruthPoint& at) const {
    const double step = a_ / 12, z = at.p_mm.z();
    const Vec2 reach((columns_ - 1) * a_ / 2 + 2 * a_, (rows_ - 1) * a_ / 2 + 2 * a_);
    double sum = 0, absolute = 0;
    for (double y = -reach.y() + step / 2; y < reach.y(); y += step)
      for (double x = -reach.x() + step / 2; x < reach.x(); x += step) {
        const Vec3 u(x, y, 0), ray = at.p_mm - u;
        const double incident = std::max(0.0, -at.n.dot(ray)), cosine = z / ray.norm();
        const Vec2 s = u.head<2>() + ray.head<2>() * (plane_separation_mm / z);
        double coefficients = 0;
        for (int cell = 0; cell < rows_ * columns_; ++cell) {
          const Vec2 t = (u.head<2>() - center(cell)) / a_;
          const double phi = basis_(t.x()) * basis_(t.y());
          if (phi != 0) coefficients += phi * image(cell, s);
        }
        const double radiance = coefficients * plane_separation_mm * plane_separation_mm / std::pow(cosine, 4);
        const double integrand = radiance * cosine * incident / std::pow(ray.norm(), 3);
        sum += integrand;
        absolute += std::abs(integrand);
      }
    return {sum * step * step, absolute * step * step};
  }

 private:
  Vec2 center(int cell) const {
    return a_ * Vec2(cell % columns_ - (columns_ - 1) / 2.0, cell / columns_ - (rows_ - 1) / 2.0);
  }
  double image(int cell, const Vec2& s) const {
    const Vec2 at = (s - grid_.corner_mm) / grid_.step_mm;
    if (at.minCoeff() < 0 || at.x() >= grid_.columns - 1 || at.y() >= grid_.rows - 1) return 0;
    const int i = static_cast<int>(at.x()), j = static_cast<int>(at.y());
    const double fx = at.x() - i, fy = at.y() - j;
    const Plane& c = images_[cell];
    return (1 - fy) * ((1 - fx) * c(j, i) + fx * c(j, i + 1)) + fy * ((1 - fx) * c(j + 1, i) + fx * c(j + 1, i + 1));
  }

  Basis basis_;
  double a_;
  ScreenGrid grid_;
  int columns_, rows_;
  std::vector<Plane> images_;
};

void expect_projected_is_scan(const WorldOptions& options, double step_mm, double tolerance,
                              const TruthGrid& grid = {}) {
  const Scan scan(options, step_mm, grid);
  const auto points = receivers();
  const auto values = truth(options, true, points, grid);
  ASSERT_EQ(values.size(), points.size());
  const double brightest = scan.irradiance(points[0]).second;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto [expected, absolute] = scan.irradiance(points[i]);
    EXPECT_NEAR(values[i].g, expected, tolerance * absolute + 1e-5 * brightest) << options.lamp << ", receiver " << i;
  }
}

TEST(Truth, ProjectedIsWhatAScanReconstructs) {
  expect_projected_is_scan({.lamp = "bike"}, 1, 2e-3);
  expect_projected_is_scan({.lamp = "led-array", .basis = BasisKind::bspline2, .window = 5}, 1, 2e-3);
  // The cut-off is 0.45 mm wide on S: images of half a millimetre still blur it.
  expect_projected_is_scan({.lamp = "headlight", .basis = BasisKind::tent}, 0.5, 5e-3);
}

TEST(Truth, ProjectionIsOfTheGridGiven) {
  // 9 × 7 cells are taken by themselves; 10 × 7 stand half a spacing aside in x.
  const WorldOptions options{.lamp = "bike"};
  expect_projected_is_scan(options, 1, 2e-3, {10, 7});
  const auto points = receivers();
  const auto own = truth(options, true, points), wider = truth(options, true, points, {11, 9}),
             aside = truth(options, true, points, {10, 7});
  bool differs = false;
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_NEAR(wider[i].g, own[i].g, 1e-6 * std::abs(own[i].g)) << "receiver " << i;
    differs = differs || std::abs(aside[i].g - own[i].g) > 1e-5 * std::abs(own[i].g);
  }
  EXPECT_TRUE(differs);
}

/// The bench's bell at 7.5 mm keeps the smooth lamps to a percent at 0.3–1 m.
TEST(Truth, BasisKeepsTheSmoothLamps) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> unit(-1, 1);
  std::vector<TruthPoint> points;
  for (int i = 0; i < 25; ++i) {
    const double z = 650 + 350 * unit(random);
    points.push_back({{0.3 * z * unit(random), 0.3 * z * unit(random), z},
                      Vec3(0.5 * unit(random), 0.5 * unit(random), -1).normalized()});
  }
  for (const char* lamp : {"bike", "led-array"}) {
    WorldOptions options;
    options.lamp = lamp;
    const auto exact = truth(options, false, points), kept = truth(options, true, points);
    double error2 = 0, sum = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      error2 += std::pow(kept[i].y - exact[i].y, 2);
      sum += exact[i].y;
    }
    const double count = static_cast<double>(points.size());
    EXPECT_LT(std::sqrt(error2 / count), 0.01 * sum / count) << lamp;
  }
}

}  // namespace
}  // namespace lumifield::virtual_bench
