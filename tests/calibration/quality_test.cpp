#include "calibration/quality.h"

#include <gtest/gtest.h>

#include <cmath>
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

Quality quality_of(const CellImage& image, float valid_share = 1) {
  Bench bench;
  bench.sensor.read_noise_e = 3;
  bench.filter.passes.resize(1);
  Plan plan;
  RawCell raw;
  raw.dark = std::make_shared<DarkSet>();
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

TEST(Quality, SaturationAboveTheLimitIsWarnedOf) {
  const Quality quality = quality_of(noisy(2000, 200), 0.2f);
  EXPECT_EQ(quality.saturated_share, 1);
  ASSERT_EQ(quality.warnings.size(), 1u);
  EXPECT_NE(quality.warnings[0].find("saturated"), std::string::npos);
}

}  // namespace
}  // namespace lumifield
