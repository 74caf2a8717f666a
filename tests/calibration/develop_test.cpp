#include "calibration/develop.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/calibration/synthetic_bench.h"

namespace lumifield {
namespace {

using testing::HasSubstr;

constexpr double cell_area = 7.5 * 7.5;

double smooth(const Vec2& s) { return 10 * (1 + 0.5 * std::sin(s.x() / 14) * std::cos(s.y() / 11) + 0.004 * s.x()); }

double blobs(const Vec2& s) {
  return 40 * std::exp(-(s - Vec2(10, 5)).squaredNorm() / 70) + 25 * std::exp(-(s - Vec2(-20, -12)).squaredNorm() / 30);
}

CellImage develop_once(const Bench& bench, const Plan& plan, const RawCell& raw) {
  auto developer = Developer::create(bench, plan);
  EXPECT_TRUE(developer) << developer.error().message();
  auto image = developer->develop(raw);
  EXPECT_TRUE(image) << image.error().message();
  return std::move(*image);
}

/// Largest |value·a_x a_y/f − 1| over the pixels of a channel.
template <class F>
double worst_relative(const CellImage& image, const Measurement& m, int channel, F f) {
  double worst = 0;
  for (int j = 0; j < m.height_px; ++j)
    for (int i = 0; i < m.width_px; ++i)
      worst = std::max(
          worst, std::abs(static_cast<double>(image.at(channel, i, j)) * cell_area / test::pixel_mean(m, i, j, f) - 1));
  return worst;
}

TEST(LuminaireGeometry, FollowsBenchAndPlan) {
  Bench bench = test::synthetic_bench();
  const Plan plan = test::synthetic_plan();
  const LuminaireGeometry mono = luminaire_geometry(bench, plan);
  EXPECT_EQ(mono.channels, std::vector<std::string>{"Y"});
  EXPECT_EQ(mono.quantity, Quantity::radiance);
  EXPECT_EQ(mono.planes.separation_mm, 150);
  EXPECT_EQ(mono.sampling.columns, 3);
  bench.camera.pixel_format = "BayerRG12";
  bench.sensor.responsivity_source.clear();
  EXPECT_EQ(luminaire_geometry(bench, plan).channels.size(), 3u);
  EXPECT_EQ(luminaire_geometry(bench, plan).quantity, Quantity::relative);
}

TEST(Develop, RecoversASmoothIrradiance) {
  const Bench bench = test::synthetic_bench();
  const Plan plan = test::synthetic_plan();
  const test::SyntheticCamera camera{bench, {}, nullptr};
  const auto rates = test::ForwardModel(bench).rates([](const Vec2& s, int) { return smooth(s); });
  const CellImage image = develop_once(bench, plan, test::synthetic_cell(camera, plan, {rates}));
  const double worst = worst_relative(image, plan.measurement, 0, smooth);
  RecordProperty("worst_relative", std::to_string(worst));
  EXPECT_LT(worst, 0.002);
  EXPECT_EQ(image.quality.saturated_share, 0);
  EXPECT_TRUE(image.quality.warnings.empty());
}

TEST(Develop, ConservesFlux) {
  const Bench bench = test::synthetic_bench();
  const Plan plan = test::synthetic_plan();
  const test::SyntheticCamera camera{bench, {}, nullptr};
  const auto rates = test::ForwardModel(bench).rates([](const Vec2& s, int) { return blobs(s); });
  const CellImage image = develop_once(bench, plan, test::synthetic_cell(camera, plan, {rates}));
  double flux = 0;
  for (const float v : image.value) flux += static_cast<double>(v) * cell_area;
  const double truth = M_PI * (40 * 70 + 25 * 30);
  RecordProperty("relative", std::to_string(flux / truth - 1));
  EXPECT_NEAR(flux / truth, 1, 2e-4);
}

TEST(Develop, KeepsASharpEdgeInPlace) {
  const Bench bench = test::synthetic_bench();
  const Plan plan = test::synthetic_plan();
  const test::SyntheticCamera camera{bench, {}, nullptr};
  const auto edge_x = [](double y) { return 3.37 + 0.21 * y; };
  const auto rates =
      test::ForwardModel(bench).rates([&](const Vec2& s, int) { return s.x() < edge_x(s.y()) ? 10.0 : 0.0; }, 8);
  const CellImage image = develop_once(bench, plan, test::synthetic_cell(camera, plan, {rates}));
  const Measurement& m = plan.measurement;
  double worst = 0, mean = 0;
  for (int j = 0; j < m.height_px; ++j) {
    double lit_mm = 0;
    for (int i = 0; i < m.width_px; ++i) lit_mm += static_cast<double>(image.at(0, i, j)) * cell_area / 10;
    const double error = m.corner_mm().x() + lit_mm - edge_x(m.pixel_center_mm(0, j).y());
    worst = std::max(worst, std::abs(error));
    mean += error / m.height_px;
  }
  RecordProperty("worst_mm", std::to_string(worst));
  EXPECT_LT(worst, 0.1);
  EXPECT_LT(std::abs(mean), 0.01);
}

TEST(Develop, CombinesPassesWithTheirScales) {
  Bench bench = test::synthetic_bench();
  bench.filter.passes = {{"positive", {0, 0}, 1.879}, {"negative", {90, 0}, -0.3}};
  const Plan plan = test::synthetic_plan();
  const test::SyntheticCamera camera{bench, {}, nullptr};
  const test::ForwardModel forward(bench);
  const auto positive = forward.rates([](const Vec2& s, int) { return smooth(s); });
  const auto negative = forward.rates([](const Vec2& s, int) { return 3 + 0.5 * smooth(s); });
  const CellImage image = develop_once(bench, plan, test::synthetic_cell(camera, plan, {positive, negative}));
  EXPECT_LT(worst_relative(image, plan.measurement, 0,
                           [](const Vec2& s) { return 1.879 * smooth(s) - 0.3 * (3 + 0.5 * smooth(s)); }),
            0.002);
}

TEST(Develop, GivesEachColourFromItsOwnPhotosites) {
  Bench bench = test::synthetic_bench();
  bench.camera.pixel_format = "BayerRG16";
  bench.sensor.responsivity = {15000, 20000, 12000};
  const Plan plan = test::synthetic_plan();
  const test::SyntheticCamera camera{bench, {}, nullptr};
  const test::ForwardModel forward(bench);

  const auto red = forward.rates([](const Vec2& s, int c) { return c == 0 ? smooth(s) : 0; });
  const CellImage pure = develop_once(bench, plan, test::synthetic_cell(camera, plan, {red}));
  for (std::size_t p = 0; p < pure.plane(); ++p) {
    ASSERT_EQ(pure.channel(1)[p], 0);
    ASSERT_EQ(pure.channel(2)[p], 0);
  }
  // Footprints of 2×2 px, h = 0.7 mm, smear a slope of 7 %/mm by up to h²/8 of it
  EXPECT_LT(worst_relative(pure, plan.measurement, 0, smooth), 0.005);

  const auto mixed = forward.rates([](const Vec2& s, int c) { return (3 - c) * smooth(s); });
  const CellImage all = develop_once(bench, plan, test::synthetic_cell(camera, plan, {mixed}));
  for (int c = 0; c < 3; ++c)
    EXPECT_LT(worst_relative(all, plan.measurement, c, [&](const Vec2& s) { return (3 - c) * smooth(s); }), 0.005);
}

TEST(Develop, ShiftsSWithACarriedLamp) {
  Bench bench = test::synthetic_bench();
  bench.filter.passes = {{"positive", {0, 0}, 1.879}, {"negative", {6, 1}, -0.3}};
  bench.stage_carries = StageCarries::lamp;
  bench.stage_to_luminaire.linear << 0, 1, -1, 0;
  bench.stage_to_luminaire.origin_mm = {1, 2};
  Plan plan = test::synthetic_plan();
  plan.columns = plan.rows = 2;
  plan.measurement = {70, 50, {1, 1}, {2, -3}};
  const test::SyntheticCamera camera{bench, {}, nullptr};
  const test::ForwardModel forward(bench);

  RawCell raw;
  raw.cell = {1, 1};
  raw.dark = camera.dark_set(plan.exposures_s);
  const Vec2 readings[] = {{2.3, 4.1}, {8.31, 5.08}};
  for (std::size_t p = 0; p < 2; ++p) {
    const Vec2 d = bench.stage_to_luminaire.linear * readings[p] + bench.stage_to_luminaire.origin_mm;
    const double scale = p == 0 ? 1 : 2;
    const auto rates = forward.rates([&](const Vec2& s, int) { return scale * smooth(s - d); });
    raw.passes.push_back({bench.filter.passes[p].name, camera.bracket(rates, plan.exposures_s), readings[p]});
  }
  const CellImage image = develop_once(bench, plan, raw);
  EXPECT_LT(worst_relative(image, plan.measurement, 0, [](const Vec2& s) { return (1.879 - 0.6) * smooth(s); }), 0.002);
}

TEST(Develop, PredictsItsVariance) {
  // Both passes share the noise of one dark set
  Bench bench = test::synthetic_bench();
  bench.filter.passes = {{"positive", {0, 0}, 1.879}, {"negative", {90, 0}, -0.3}};
  bench.sensor.responsivity = {200};
  Plan plan = test::synthetic_plan();
  plan.measurement = {48, 36, {2, 2}, {2, -3}};
  const test::ForwardModel forward(bench);
  const auto rates = forward.rates([](const Vec2& s, int) { return 3 * blobs(s); }, 2);
  std::vector<double> dark(rates.size(), 30);

  auto developer = Developer::create(bench, plan);
  ASSERT_TRUE(developer);
  const test::SyntheticCamera still{bench, dark, nullptr};
  const CellImage mean = *developer->develop(test::synthetic_cell(still, plan, {rates, rates}));
  double squares = 0, sum = 0;
  int count = 0;
  for (int seed = 0; seed < 6; ++seed) {
    std::mt19937_64 random(static_cast<std::uint64_t>(seed));
    const test::SyntheticCamera camera{bench, dark, &random};
    const CellImage image = *developer->develop(test::synthetic_cell(camera, plan, {rates, rates}));
    for (std::size_t p = 0; p < image.plane(); ++p, ++count) {
      const double z = static_cast<double>((image.value[p] - mean.value[p]) / std::sqrt(image.variance[p]));
      squares += z * z, sum += z;
    }
  }
  RecordProperty("normalised_variance", std::to_string(squares / count));
  RecordProperty("normalised_mean", std::to_string(sum / count));
  EXPECT_NEAR(squares / count, 1, 0.06);
  EXPECT_NEAR(sum / count, 0, 0.06);
}

TEST(Develop, BracketsBeyondThePlansSayTheSame) {
  // Of 65 000 DN the lamp reaches 40 000 at 0.128 s: each pass has its own exposures, all have their dark frames.
  Bench bench = test::synthetic_bench();
  bench.filter.passes = {{"positive", {0, 0}, 1.879}, {"negative", {90, 0}, -0.3}};
  bench.sensor.responsivity = {10000};
  Plan plan = test::synthetic_plan();
  plan.measurement = {48, 36, {2, 2}, {2, -3}};
  const auto rates = test::ForwardModel(bench).rates([](const Vec2& s, int) { return smooth(s); }, 2);
  auto developer = Developer::create(bench, plan);
  ASSERT_TRUE(developer);
  std::mt19937_64 random(9);
  const test::SyntheticCamera camera{bench, std::vector<double>(rates.size(), 30), &random};
  RawCell raw = test::synthetic_cell(camera, plan, {rates, rates});
  const auto whole = developer->develop(raw);
  ASSERT_TRUE(whole) << whole.error().message();
  EXPECT_TRUE(whole->quality.exposures_s.empty());

  raw.dark = camera.dark_set({0.0005, 0.002, 0.008, 0.032, 0.128, 0.512});
  raw.passes[0].bracket = camera.bracket(rates, {0.0005, 0.002, 0.008, 0.032, 0.128});
  raw.passes[1].bracket = camera.bracket(rates, {0.002, 0.008, 0.032, 0.128, 0.512});
  const auto more = developer->develop(raw);
  ASSERT_TRUE(more) << more.error().message();
  raw.passes[0].bracket = camera.bracket(rates, {0.008, 0.032, 0.128});
  raw.passes[1].bracket = camera.bracket(rates, {0.128});
  const auto fewer = developer->develop(raw);
  ASSERT_TRUE(fewer) << fewer.error().message();
  EXPECT_THAT(more->quality.exposures_s, testing::SizeIs(2));
  EXPECT_EQ(fewer->quality.exposures_s.at("negative"), std::vector<double>{0.128});

  for (const CellImage* other : {&*more, &*fewer}) {
    double squares = 0, sum = 0;
    for (std::size_t p = 0; p < whole->plane(); ++p) {
      const double z =
          static_cast<double>((other->value[p] - whole->value[p]) / std::sqrt(other->variance[p] + whole->variance[p]));
      squares += z * z, sum += z;
    }
    const auto count = static_cast<double>(whole->plane());
    RecordProperty(other == &*more ? "more" : "fewer", std::to_string(squares / count));
    // Variance of the mean square of 1728 normal variates: 2/1728; of their mean: 1/1728. Four standard deviations.
    EXPECT_NEAR(squares / count, 1, 4 * std::sqrt(2 / count));
    EXPECT_NEAR(sum / count, 0, 4 / std::sqrt(count));
  }
}

TEST(Develop, SurvivesHotPixels) {
  Bench bench = test::synthetic_bench();
  const Plan plan = test::synthetic_plan();
  const auto rates = test::ForwardModel(bench).rates([](const Vec2& s, int) { return smooth(s); });
  std::vector<double> dark(rates.size(), 50);
  std::mt19937_64 random(3);
  for (int n = 0; n < 2000; ++n) dark[random() % dark.size()] = n % 2 ? 1e9 : 300000;  // stuck, hot in long exposures
  const test::SyntheticCamera camera{bench, dark, nullptr};
  const CellImage image = develop_once(bench, plan, test::synthetic_cell(camera, plan, {rates}));
  // A missing photosite leaves its neighbours to speak for the pixel
  EXPECT_LT(worst_relative(image, plan.measurement, 0, smooth), 0.03);
  EXPECT_EQ(image.quality.saturated_share, 0);
  EXPECT_GT(image.quality.dark_dn, 240);
}

TEST(Develop, ReportsSaturationAsLowerBound) {
  const Bench bench = test::synthetic_bench();
  const Plan plan = test::synthetic_plan();
  const auto disc = [](const Vec2& s) { return (s - Vec2(5, 5)).norm() < 10 ? 5000.0 : 5.0; };
  const auto rates = test::ForwardModel(bench).rates([&](const Vec2& s, int) { return disc(s); });
  const test::SyntheticCamera camera{bench, {}, nullptr};
  const CellImage image = develop_once(bench, plan, test::synthetic_cell(camera, plan, {rates}));
  EXPECT_NEAR(image.quality.saturated_share, M_PI * 100 / (96 * 72), 0.004);
  EXPECT_THAT(image.quality.warnings, testing::Contains(HasSubstr("saturated")));
  const int i = 50, j = 44;  // pixel of the disc's centre
  EXPECT_LT(image.at(0, i, j) * cell_area, 5000);
  EXPECT_GT(image.at(0, i, j) * cell_area, 500);
  const double variance = static_cast<double>(image.variance[static_cast<std::size_t>(j * 96 + i)]);
  EXPECT_NEAR(std::sqrt(variance) / static_cast<double>(image.at(0, i, j)), 1, 0.02);
  for (const float v : image.variance) ASSERT_TRUE(std::isfinite(v));
}

TEST(Develop, WithoutDarkSetSaysSoAndKeepsNegatives) {
  Bench bench = test::synthetic_bench();
  const Plan plan = test::synthetic_plan();
  std::mt19937_64 random(1);
  const test::SyntheticCamera camera{bench, {}, &random};
  const std::vector<double> nothing(320 * 240, 0.0);
  RawCell raw = test::synthetic_cell(camera, plan, {nothing});
  raw.dark = nullptr;
  raw.position_error_mm = 0.5;
  raw.drift = -0.02;
  const CellImage image = develop_once(bench, plan, raw);
  const auto negative = std::count_if(image.value.begin(), image.value.end(), [](float v) { return v < 0; });
  EXPECT_GT(negative, 2000);
  EXPECT_GT(image.quality.starved_share, 0.99);
  EXPECT_TRUE(std::isnan(image.quality.dark_dn));
  EXPECT_THAT(image.quality.warnings, testing::Contains(HasSubstr("no dark set")));
  EXPECT_THAT(image.quality.warnings, testing::Contains(HasSubstr("0.5 mm")));
  EXPECT_THAT(image.quality.warnings, testing::Contains(HasSubstr("drifted by -2 %")));
}

}  // namespace
}  // namespace lumifield
