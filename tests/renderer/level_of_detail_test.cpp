#include <cmath>
#include <gtest/gtest.h>
#include <set>

#include "renderer/methods/closed_form.h"
#include "renderer/methods/image_levels.h"
#include "renderer/study/definition_quadrature.h"
#include "tests/support/closed_form_cases.h"
#include "tests/support/coarse_luminaires.h"

namespace lumifield {
namespace {

TEST(ImageLevels, AreMeansOfThePaddedImage) {
  for (const auto& [width, height] : {std::pair(44, 37), {300, 300}, {1, 9}, {64, 1}, {33, 2}}) {
    std::vector<float> image;
    for (int k = 0; k < width * height; ++k) image.push_back(static_cast<float>((k * 7919) % 257 - 100));
    const std::vector<ImageLevel> levels = coarse_levels(image.data(), width, height);
    ASSERT_EQ(static_cast<int>(levels.size()), coarsest_level(width, height));
    for (std::size_t k = 0; k < levels.size(); ++k) {
      const int n = 2 << k;
      ASSERT_EQ(levels[k].width_px, (width + n - 1) / n);
      ASSERT_EQ(levels[k].height_px, (height + n - 1) / n);
      std::vector<double> mean(levels[k].value.size(), 0.0);
      for (int j = 0; j < height; ++j)
        for (int i = 0; i < width; ++i)
          mean[std::size_t(j / n * levels[k].width_px + i / n)] += image[std::size_t(j * width + i)];
      for (double& v : mean) v /= double(n) * n;
      EXPECT_EQ(levels[k].value, mean) << width << "x" << height << " level " << k + 1;
    }
    EXPECT_EQ(levels.back().value.size(), 1U);
  }
}

TEST(ImageLevels, TheCoarsestIsOnePixel) {
  EXPECT_EQ(coarsest_level(1, 1), 0);
  EXPECT_EQ(coarsest_level(2, 1), 1);
  EXPECT_EQ(coarsest_level(3, 4), 2);
  EXPECT_EQ(coarsest_level(300, 300), 9);
  EXPECT_EQ(coarsest_level(1 << 30, 5), 30);
}

TEST(ImageLevels, TheLevelIsTheFinestThatFits) {
  EXPECT_EQ(level_of_detail(0, 1e9, 9), 0);
  EXPECT_EQ(level_of_detail(8, 8, 9), 0);
  EXPECT_EQ(level_of_detail(8, 8.001, 9), 1);
  EXPECT_EQ(level_of_detail(8, 16, 9), 1);
  EXPECT_EQ(level_of_detail(8, 17, 9), 2);
  EXPECT_EQ(level_of_detail(8, 1e9, 9), 9);
  EXPECT_EQ(level_of_detail(1e-300, 0, 9), 0);
}

class LevelOfDetailOf : public testing::TestWithParam<BasisKind> {
 protected:
  const LightField field_ = whole_numbers(random_luminaire(GetParam(), 1, 41));
  const std::vector<ReceiverCase> cases_ = receiver_cases(field_.geometry(), 42);
};
INSTANTIATE_TEST_SUITE_P(All, LevelOfDetailOf,
                         testing::Values(BasisKind::box, BasisKind::tent, BasisKind::bell, BasisKind::bspline2),
                         [](const auto& each) { return std::string(to_string(each.param)); });

TEST_P(LevelOfDetailOf, EqualsTheDefinitionOfTheMeanImages) {
  std::vector<LightField> means;
  for (int level = 0; level <= 6; ++level) means.push_back(mean_luminaire(field_, level));
  std::set<int> seen;
  for (double lod : {20.0, 5.0, 1.3, 0.1}) {
    const ClosedForm closed_form(field_, lod);
    for (const ReceiverCase& each : cases_) {
      const int level = expected_level(field_.geometry(), each.p_mm.z(), lod);
      seen.insert(level);
      const DefinitionValue expected = definition_quadrature(means[std::size_t(level)], each.p_mm, each.n);
      const double error = std::abs(closed_form.irradiance({each.p_mm, each.n})[0] - expected.irradiance[0]);
      const double tolerance = each.cut_horizon && each.p_mm.z() < 0.1 ? 1e-10 : 1e-12;
      EXPECT_LE(error, tolerance * expected.magnitude[0])
          << each.name << ", T = " << lod << ", level " << level << ", p " << each.p_mm.transpose() << " n "
          << each.n.transpose();
    }
  }
  EXPECT_EQ(seen, (std::set<int>{0, 1, 2, 3, 4, 5, 6}));
}

TEST_P(LevelOfDetailOf, AllPixelsAreExact) {
  const ClosedForm exact(field_), none(field_, 0), all(field_, 1e300);
  for (const ReceiverCase& each : cases_) {
    const Receiver receiver{each.p_mm, each.n};
    EXPECT_EQ(none.irradiance(receiver), exact.irradiance(receiver)) << each.name;
    EXPECT_EQ(all.irradiance(receiver), exact.irradiance(receiver)) << each.name;
  }
}

/// |error| ≤ δ²a_x a_y/(δ+Δ)³ Σ |g|·max(C_max − C̄, C̄ − C_min), the sum over the level's pixels.
TEST_P(LevelOfDetailOf, ErrorStaysWithinItsBound) {
  const ClosedForm exact(field_);
  double greatest = 0;
  for (double lod : {6.0, 2.0}) {
    const ClosedForm coarse(field_, lod);
    for (const ReceiverCase& each : cases_) {
      const int level = expected_level(field_.geometry(), each.p_mm.z(), lod);
      const double expected =
          definition_quadrature(deviation_luminaire(field_, level), each.p_mm, each.n).irradiance[0];
      const double magnitude = definition_quadrature(field_, each.p_mm, each.n).magnitude[0];
      const Receiver receiver{each.p_mm, each.n};
      const double bound = coarse.detail_error_bound(receiver)[0];
      EXPECT_NEAR(bound, expected, 1e-7 * expected) << each.name << ", T = " << lod << ", level " << level;
      const double error = std::abs(coarse.irradiance(receiver)[0] - exact.irradiance(receiver)[0]);
      EXPECT_LE(error, bound + 1e-12 * magnitude) << each.name << ", T = " << lod << ", level " << level;
      if (bound > 0) greatest = std::max(greatest, error / bound);
    }
  }
  EXPECT_GT(greatest, 0.1);  // else the bound would say nothing
}

}  // namespace
}  // namespace lumifield
