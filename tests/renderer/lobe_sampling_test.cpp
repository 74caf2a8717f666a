// Directions drawn as surfaces reflect: their density, their weights, and back.
#include "renderer/methods/lobe_sampling.h"

#include <Eigen/Geometry>
#include <cmath>
#include <gtest/gtest.h>
#include <numbers>
#include <random>

#include "renderer/methods/gloss.h"
#include "tests/support/chi_square.h"

namespace lumifield {
namespace {

constexpr double pi = std::numbers::pi;
const Vec3 normal = Vec3(0.3, -0.5, -0.8).normalized();

/// In a frame whose z is the normal.
Vec3 from_normal(double cosine, double phi) {
  const double sine = std::sqrt(std::max(1 - cosine * cosine, 0.0));
  Vec3 across, along;
  frame_about(normal, across, along);
  return sine * std::cos(phi) * across + sine * std::sin(phi) * along + cosine * normal;
}

GlossLobe lobe_of(int kind, double shape, double eye_angle) {
  const Eigen::Vector3f o = from_normal(std::cos(eye_angle), 0.7).cast<float>();
  return {o.x(), o.y(), o.z(), static_cast<float>(shape), 0.3F, 0.5F, 0.9F, kind};
}

LobePoint point(double x, double y) { return {x, std::log(x), std::cos(2 * pi * y), std::sin(2 * pi * y)}; }

const GlossLobe lobes[] = {lobe_of(LOBE_NONE, 0, 0),     lobe_of(LOBE_PHONG, 1, 0.4),   lobe_of(LOBE_PHONG, 50, 1.1),
                           lobe_of(LOBE_GGX, 0.09, 0.3), lobe_of(LOBE_GGX, 0.09, 1.45), lobe_of(LOBE_GGX, 0.5, 1.2),
                           lobe_of(LOBE_GGX, 1, 0)};
std::string named(const GlossLobe& lobe) {
  return "kind " + std::to_string(lobe.kind) + ", shape " + std::to_string(lobe.shape);
}

/// ∫ g dω over the sphere: midpoints about the lobe's axis, dense towards it.
template <class G>
double over_sphere(const LobeDistribution& about, const G& g) {
  Vec3 across, along;
  frame_about(about.axis(), across, along);
  constexpr int rings = 3000, around = 128;
  double sum = 0;
  for (int i = 0; i < rings; ++i) {
    // cosθ = 1 − 2 x³, dω = 6 x² dx dφ.
    const double x = (i + 0.5) / rings, cosine = 1 - 2 * x * x * x, sine = std::sqrt(1 - cosine * cosine);
    for (int j = 0; j < around; ++j) {
      const double phi = 2 * pi * (j + 0.5) / around;
      sum += 6 * x * x * g(Vec3(sine * std::cos(phi) * across + sine * std::sin(phi) * along + cosine * about.axis()));
    }
  }
  return sum * 2 * pi / (rings * around);
}

TEST(LobeDistribution, DensityIntegratesToOneButForWhatIsBelowTheSurface) {
  for (const GlossLobe& lobe : lobes) {
    const LobeDistribution draws(lobe, normal);
    const double all = over_sphere(draws, [&](const Vec3& i) { return draws.pdf(i); });
    EXPECT_NEAR(all, 1, 2e-3) << named(lobe);
  }
}

TEST(LobeDistribution, DrawsByItsDensity) {
  for (const GlossLobe& lobe : lobes) {
    const LobeDistribution draws(lobe, normal);
    const auto sample = [&](double xi1, double xi2, double& x, double& y) {
      const LobeDraw draw = draws.sample(point(std::max(xi1, 1e-12), xi2));
      EXPECT_NEAR(draw.direction.norm(), 1, 1e-12);
      const double pdf = draws.pdf(draw.direction);
      EXPECT_NEAR(draw.pdf, pdf, 1e-7 * pdf) << named(lobe);
      x = normal.dot(draw.direction);
      Vec3 across, along;
      frame_about(normal, across, along);
      y = std::atan2(along.dot(draw.direction), across.dot(draw.direction));
      return true;
    };
    const ChiSquare test = chi_square_2d({-1, 1, -pi, pi, 24, 24, 24}, 60000, 3, sample,
                                         [&](double x, double y) { return draws.pdf(from_normal(x, y)); });
    EXPECT_TRUE(test.plausible()) << named(lobe) << ": " << test.text();
  }
}

TEST(LobeDistribution, WeighsAsTheSurfaceReflects) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> unit(1e-9, 1);
  for (const GlossLobe& lobe : lobes) {
    const LobeDistribution draws(lobe, normal);
    int above = 0;
    for (int k = 0; k < 500; ++k) {
      const LobeDraw draw = draws.sample(point(unit(random), unit(random)));
      const double facing = std::max(normal.dot(draw.direction), 0.0);
      const auto f = lobe.kind == LOBE_NONE ? std::array{1.0, 1.0, 1.0} : glossy_brdf(lobe, normal, draw.direction);
      above += facing > 0;
      for (std::size_t c = 0; c < 3; ++c)
        EXPECT_NEAR(draw.weight[c], f[c] * facing / draw.pdf, 1e-9 * draw.weight[c]) << named(lobe);
    }
    EXPECT_GT(above, 100);
  }
}

TEST(LobeDistribution, MeanWeightIsWhatIsReflected) {
  for (const GlossLobe& lobe : lobes) {
    const LobeDistribution draws(lobe, normal);
    const double all = over_sphere(draws, [&](const Vec3& i) {
      return std::max(normal.dot(i), 0.0) * (lobe.kind == LOBE_NONE ? 1 : glossy_brdf(lobe, normal, i)[1]);
    });
    double mean = 0;
    const auto points = lobe_points(PointSequence::halton, 4096, 5, LobeDraws::glossy);
    for (const LobePoint& xi : points) mean += draws.sample(xi).weight[1] / static_cast<double>(points.size());
    EXPECT_NEAR(mean, all, 3e-3 * all) << named(lobe);
  }
}

TEST(LobeDistribution, InvertsWhatItDraws) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> unit(1e-6, 1);
  for (const GlossLobe& lobe : lobes) {
    const LobeDistribution draws(lobe, normal);
    for (int k = 0; k < 500; ++k) {
      const double x = unit(random), y = unit(random);
      const Vec2 back = draws.invert(draws.sample(point(x, y)).direction);
      EXPECT_NEAR(back.x(), x, 1e-6) << named(lobe);
      EXPECT_NEAR(std::remainder(back.y() - y, 1.0) * std::sqrt(x), 0, 1e-6) << named(lobe);
    }
  }
}

TEST(LobeDistribution, OfAnEyeBelowTheSurfaceHasNoWeight) {
  for (const int kind : {LOBE_PHONG, LOBE_GGX}) {
    const LobeDistribution draws(lobe_of(kind, 0.5, 1.8), normal);
    EXPECT_FALSE(draws.shines());
    EXPECT_EQ(draws.sample(point(0.3, 0.4)).weight[0], 0);
    EXPECT_EQ(draws.pdf(normal), 0);
  }
}

TEST(LobePoints, ThatJudgeAreManyMoreButNotWithoutEnd) {
  for (const auto& [n, many] :
       {std::pair(1, 4096), {256, 4096}, {300, 4800}, {4096, 65536}, {60'000, 65536}, {100'000, 100'000}})
    EXPECT_EQ(judging_points(n).size(), many) << n;
}

TEST(LobePoints, AreSpreadEvenlyAndUniformOverSeeds) {
  std::vector<double> first(16, 0.0);
  const std::vector<double> expected(16, 500.0);
  for (std::uint32_t seed = 1; seed <= 8000; ++seed) {
    const LobePoint xi = lobe_points(PointSequence::halton, 1, seed, LobeDraws::diffuse)[0];
    const double y = std::atan2(xi.sin_phi, xi.cos_phi) / (2 * pi);
    first[static_cast<std::size_t>(4 * xi.x) + 4 * static_cast<std::size_t>(4 * (y < 0 ? y + 1 : y))] += 1;
  }
  EXPECT_TRUE(chi_square(first, expected).plausible());
  // Of 64 points one stands in each of 8×8 squares.
  std::vector<int> squares(64, 0);
  for (const LobePoint& xi : lobe_points(PointSequence::halton, 64, 9, LobeDraws::glossy)) {
    EXPECT_GT(xi.x, 0);
    EXPECT_NEAR(xi.log_x, std::log(xi.x), 1e-15);
    squares[static_cast<std::size_t>(8 * xi.x)] += 1;
  }
  for (std::size_t column = 0; column < 8; ++column) EXPECT_EQ(squares[column], 8);
}

TEST(LobePoints, AreTurnedByAnAngleOfEachReceiver) {
  const std::vector<double> expected(16, 500.0);
  for (const LobeDraws draws : {LobeDraws::diffuse, LobeDraws::glossy}) {
    std::vector<double> angles(16, 0.0), steps(16, 0.0);
    double before = 0;
    for (std::uint32_t receiver = 0; receiver < 8000; ++receiver) {
      const LobePoint xi = turned(point(0.3, 0.7), lobe_turn(receiver, 5, draws));
      EXPECT_EQ(xi.x, 0.3);
      EXPECT_EQ(xi.log_x, std::log(0.3));
      EXPECT_NEAR(std::hypot(xi.cos_phi, xi.sin_phi), 1, 1e-14);
      const double turn = std::atan2(xi.sin_phi, xi.cos_phi) / (2 * pi) + 0.5, step = turn - before;
      angles[std::min(static_cast<std::size_t>(16 * turn), std::size_t{15})] += 1;
      steps[std::min(static_cast<std::size_t>(16 * (step - std::floor(step))), std::size_t{15})] += 1;
      before = turn;
    }
    EXPECT_TRUE(chi_square(angles, expected).plausible());
    EXPECT_TRUE(chi_square(steps, expected).plausible()) << "from one receiver to the next";
  }
}

}  // namespace
}  // namespace lumifield
