#include "calibration/quality.h"

#include <cmath>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <random>

namespace lumifield {
namespace {

constexpr int side = 100;

/// Noise of σ = 1 everywhere, and `level` on the first `lit` pixels.
CellImage noisy(std::size_t lit, float level) {
  CellImage image{side, side, 1, std::vector<float>(side * side), std::vector<float>(side * side, 1.0f), {}};
  std::mt19937 random(4);
  std::normal_distribution<float> noise;
  for (std::size_t p = 0; p < image.value.size(); ++p) image.value[p] = noise(random) + (p < lit ? level : 0);
  return image;
}

/// With a reference cell whose mean is `reference` in units of the values; 0 = none.
Quality quality_of(const CellImage& image, float valid_share = 1, double reference = 0) {
  Bench bench;
  bench.sensor.read_noise_e = 3;
  bench.sensor.gain_dn_per_e = 0.5;
  bench.sensor.responsivity = {4};
  bench.filter.spacing_mm = {2, 3};
  bench.filter.passes = {{"only", {0, 0}, 1.5}};
  Plan plan;
  RawCell raw;
  raw.dark = std::make_shared<DarkSet>();
  raw.passes.resize(1);
  raw.passes[0].bracket.resize(1);
  if (reference > 0) raw.reference_dn_per_s = reference * 0.5 * 4 * 2 * 3 / 1.5;
  const ScreenFaults faults{std::vector<float>(image.value.size(), valid_share),
                            std::vector<float>(image.value.size(), 100.0f)};
  return judge(image, faults, raw, 64, bench, plan);
}

TEST(Quality, ADarkCellIsNoFault) {
  const Quality quality = quality_of(noisy(0, 0));
  EXPECT_TRUE(std::isnan(quality.median_snr));
  EXPECT_TRUE(quality.warnings.empty()) << quality.warnings.front();
}

TEST(Quality, ALitCellHasTheSnrOfItsLitPixels) {
  const Quality bright = quality_of(noisy(2000, 200));
  EXPECT_NEAR(bright.median_snr, 200, 1);
  EXPECT_TRUE(bright.warnings.empty());
}

TEST(Quality, AFaintCellIsWarnedOf) {
  const Quality faint = quality_of(noisy(2000, 8));
  ASSERT_EQ(faint.warnings.size(), 1u);
  EXPECT_NE(faint.warnings[0].find("median SNR"), std::string::npos);
}

/// A rim cell: a few pixels of faint light beside a lamp that is bright elsewhere.
TEST(Quality, ACellOfAWellExposedScanThatHoldsHardlyAnyLightIsNoFault) {
  const Quality rim = quality_of(noisy(500, 8), 1, 5000);
  EXPECT_TRUE(std::isnan(rim.median_snr));
  EXPECT_TRUE(rim.warnings.empty()) << rim.warnings.front();
}

TEST(Quality, OnlyPixelsAboveAShareOfTheReferenceCount) {
  CellImage image = noisy(2000, 200);
  for (std::size_t p = 2000; p < 6000; ++p) image.value[p] += 20;
  EXPECT_NEAR(quality_of(image, 1, 5000).median_snr, 200, 1);    // lit above 50
  EXPECT_NEAR(quality_of(image, 1, 500).median_snr, 20.7, 0.5);  // lit above 5
  EXPECT_TRUE(std::isnan(quality_of(image, 1, 50'000).median_snr));
}

TEST(Quality, AStarvedScanIsWarnedOfInLitAndInDarkCells) {
  for (const CellImage& image : {noisy(5000, 8), noisy(0, 0)}) {
    const Quality starved = quality_of(image, 1, 50);
    ASSERT_EQ(starved.warnings.size(), 1u);
    EXPECT_THAT(starved.warnings[0], testing::HasSubstr("lit pixels is below the plan's 20"));
  }
}

TEST(Quality, TellsTheExposuresOfPassesThatTookOthersThanThePlans) {
  RawCell raw;
  raw.dark = std::make_shared<DarkSet>();
  raw.passes = {{"positive", Bracket(3), {0, 0}}, {"negative", Bracket(2), {0, 0}}};
  for (RawPass& pass : raw.passes) {
    double exposure_s = 0.008;
    for (auto frame = pass.bracket.rbegin(); frame != pass.bracket.rend(); ++frame, exposure_s /= 4)
      frame->exposure_s = exposure_s;
  }
  Bench bench;
  bench.sensor.responsivity = {1};
  bench.filter.passes = {{"positive", {0, 0}, 1.5}, {"negative", {9, 0}, -0.5}};
  Plan plan;
  plan.exposures_s = {0.002, 0.008};
  const ScreenFaults faults{std::vector<float>(side * side, 1), std::vector<float>(side * side, 100)};
  const Quality quality = judge(noisy(0, 0), faults, raw, 64, bench, plan);
  const std::map<std::string, std::vector<double>> taken{{"positive", {0.0005, 0.002, 0.008}}};
  EXPECT_EQ(quality.exposures_s, taken);
}

TEST(Quality, SaturationAboveTheLimitIsWarnedOf) {
  const Quality quality = quality_of(noisy(2000, 200), 0.2f);
  EXPECT_EQ(quality.saturated_share, 1);
  ASSERT_EQ(quality.warnings.size(), 1u);
  EXPECT_NE(quality.warnings[0].find("saturated"), std::string::npos);
}

}  // namespace
}  // namespace lumifield
