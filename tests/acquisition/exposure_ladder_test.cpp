#include "acquisition/scan/exposure_ladder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace lumifield {
namespace {

using testing::DoubleEq;
using testing::ElementsAre;

ExposureLadder ladder_of(std::vector<double> exposures_s, std::optional<ExposureLimits> limits = {}) {
  Plan plan;
  plan.exposures_s = std::move(exposures_s);
  plan.exposure_limits_s = limits;
  return exposure_ladder(plan);
}

TEST(ExposureLadder, IsThePlansWithoutLimitsOrWithin) {
  for (const auto& limits : {std::optional<ExposureLimits>(), std::optional<ExposureLimits>({0.002, 0.008})}) {
    const ExposureLadder ladder = ladder_of({0.002, 0.008}, limits);
    EXPECT_THAT(ladder.exposures_s, ElementsAre(0.002, 0.008));
    EXPECT_EQ(ladder.plan_begin, 0U);
    EXPECT_EQ(ladder.plan_end, 2U);
  }
}

TEST(ExposureLadder, GoesOnInTheRatiosOfItsEnds) {
  const ExposureLadder ladder = ladder_of({0.004, 0.008, 0.08}, {{0.001, 10}});
  EXPECT_THAT(ladder.exposures_s,
              ElementsAre(DoubleEq(0.001), DoubleEq(0.002), 0.004, 0.008, 0.08, DoubleEq(0.8), DoubleEq(8)));
  EXPECT_EQ(ladder.plan_begin, 2U);
  EXPECT_EQ(ladder.plan_end, 5U);
}

TEST(ExposureLadder, ASingleExposureGoesInFours) {
  EXPECT_THAT(ladder_of({0.02}, {{0.005, 0.1}}).exposures_s, ElementsAre(DoubleEq(0.005), 0.02, DoubleEq(0.08)));
}

TEST(ExposureLadder, KeepsBothEndsInSpiteOfRounding) {
  const double ratio = 0.006 / 0.002;
  ASSERT_LT(0.002 / ratio / ratio, 0.002 / 9);
  ASSERT_GT(0.006 * ratio * ratio, 0.054);
  EXPECT_EQ(ladder_of({0.002, 0.006}, {{0.002 / 9, 0.054}}).size(), 6U);
}

TEST(ExposureLadder, IsBoundedWhereTheRatioIsNearOne) {
  EXPECT_EQ(ladder_of({0.002, 0.00200001}, {{1e-6, 10}}).size(), most_exposures + 1);
}

/// 1000 pixels between black at 64 and saturation at 4064, those of `bright` at that value, the others at 64.
class AFrame : public testing::Test {
 protected:
  static RawImage frame(std::uint16_t bright_dn, std::size_t bright, std::uint16_t others_dn = 64) {
    RawImage image;
    image.dn.assign(1000, others_dn);
    std::fill_n(image.dn.begin(), bright, bright_dn);
    return image;
  }
  bool may_be_longer(const RawImage& image) const {
    return lumifield::may_be_longer(image, frame(64, 0), 4, sensor, 0.01);
  }
  Sensor sensor{64, 1, 0, 4064, {1}, {}, {}};
};

TEST_F(AFrame, IsSaturatedAboveTheShare) {
  EXPECT_FALSE(is_saturated(frame(4064, 10), sensor, 0.01));
  EXPECT_TRUE(is_saturated(frame(4064, 11), sensor, 0.01));
  EXPECT_FALSE(is_saturated(frame(4063, 1000), sensor, 0.01));
  EXPECT_TRUE(is_saturated(frame(4064, 1), sensor, 0));
}

TEST_F(AFrame, MayBeLongerWhileThatDoesNotSaturate) {
  EXPECT_TRUE(may_be_longer(frame(1063, 1000)));
  EXPECT_FALSE(may_be_longer(frame(1064, 11, 100)));  // 4·(1064 − 64) + 64 = 4064
  EXPECT_TRUE(may_be_longer(frame(1064, 10, 100)));
}

TEST_F(AFrame, IsNotWorthMoreTimeWithoutLight) {
  EXPECT_FALSE(may_be_longer(frame(64, 0)));
  // n of 1000 pixels at 1 DN: mean n/1000, standard error √(n/1000 (1 − n/1000)/1000); five of them at n = 24.4
  EXPECT_FALSE(may_be_longer(frame(65, 24)));
  EXPECT_TRUE(may_be_longer(frame(65, 25)));
  EXPECT_FALSE(lumifield::may_be_longer(frame(65, 25), RawImage{}, 4, sensor, 0.01));
}

}  // namespace
}  // namespace lumifield
