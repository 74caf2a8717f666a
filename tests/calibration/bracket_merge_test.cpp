#include "calibration/bracket_merge.h"

#include <gtest/gtest.h>

#include "tests/calibration/synthetic_bench.h"

namespace lumifield {
namespace {

/// A sensor whose every photosite sees the same rate: a sample of as many merges.
struct Sample {
  double mean = 0, variance = 0, predicted = 0;
  int invalid = 0;
};

class Merge : public testing::TestWithParam<double> {
 protected:
  Merge() : bench_(test::synthetic_bench()) {
    bench_.camera_model.width_px = 256, bench_.camera_model.height_px = 160;
    bench_.sensor = {64, 0.4, 5, 4095, {1}, "", ""};
  }

  Sample run(double rate, double dark, std::uint64_t seed) {
    std::mt19937_64 random(seed);
    const std::size_t n = 256 * 160;
    const test::SyntheticCamera camera{bench_, std::vector<double>(n, dark), &random};
    const Bracket bracket = camera.bracket(std::vector<double>(n, rate), exposures_);
    const DarkModel model(camera.dark_set(exposures_), bench_.sensor);
    std::vector<PhotositeSignal> out(n);
    const WeightedBracket one{&bracket, 1};
    merge_brackets({&one, 1}, &model, bench_.sensor, std::vector<float>(n, 1.0f), std::vector<RowSpan>(160, {0, 256}),
                   out);
    Sample s;
    for (const PhotositeSignal& p : out) {
      s.invalid += p.valid != 1;
      s.mean += static_cast<double>(p.value) / static_cast<double>(n);
      s.predicted += static_cast<double>(p.variance) / static_cast<double>(n);
    }
    for (const PhotositeSignal& p : out)
      s.variance += std::pow(static_cast<double>(p.value) - s.mean, 2) / static_cast<double>(n);
    return s;
  }

  Bench bench_;
  std::vector<double> exposures_{0.002, 0.008, 0.032, 0.128};
};

/// The well holds (4095 − 64)/0.4 ≈ 10080 e⁻: rates of nothing, of a few electrons, through the fades of each exposure
/// (78 700, 315 000, 1 260 000 e⁻/s fill the well) up to nearly the whole range of the shortest.
INSTANTIATE_TEST_SUITE_P(Rates, Merge,
                         testing::Values(0.0, 8.0, 40.0, 150.0, 400.0, 1000.0, 3000.0, 10000.0, 60000.0, 70000.0,
                                         75000.0, 77000.0, 78000.0, 78700.0, 79500.0, 300000.0, 313000.0, 1250000.0,
                                         4500000.0));

TEST_P(Merge, IsUnbiasedAndPredictsItsVariance) {
  const double rate = GetParam();
  const Sample s = run(rate, 20, 7);
  EXPECT_EQ(s.invalid, 0);
  // 40960 merges: the mean is known to 0.005 σ, the variance to 0.7 %
  const double sigma = std::sqrt(s.variance);
  RecordProperty("bias_in_sigma", std::to_string((s.mean - rate) / sigma));
  RecordProperty("predicted_over_sample", std::to_string(s.predicted / s.variance));
  EXPECT_LT(std::abs(s.mean - rate) / sigma, 0.02);
  EXPECT_NEAR(s.predicted / s.variance, 1, 0.03);
}

}  // namespace
}  // namespace lumifield
