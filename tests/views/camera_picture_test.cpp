#include "app/views/camera_picture.h"

#include <QSignalSpy>
#include <QTest>
#include <gtest/gtest.h>
#include <numeric>

#include "app/views/camera_picture_maker.h"

namespace lumifield {
namespace {

/// 4 × 2 photosites.
std::shared_ptr<const Bracket> one(std::vector<std::uint16_t> dn, SensorPattern pattern, int bits = 12) {
  RawImage raw;
  raw.width_px = 4;
  raw.height_px = 2;
  raw.bits = bits;
  raw.pattern = pattern;
  raw.dn = std::move(dn);
  return std::make_shared<const Bracket>(Bracket{raw});
}

TEST(CameraPicture, ShowsLightAsSrgbAndMarksWhatIsOverExposed) {
  const auto picture = make_camera_picture(one({0, 876, 4095, 1, 4000, 3999, 0, 4095}, SensorPattern::mono), 0, 4000,
                                           CameraColours::blocks);
  EXPECT_EQ(picture.step, 1);
  ASSERT_EQ(picture.image.size(), QSize(4, 2));
  EXPECT_EQ(qGray(picture.image.pixel(0, 0)), 0);
  EXPECT_EQ(qGray(picture.image.pixel(1, 0)), 127);  // 21.4 % of the light
  EXPECT_EQ(qGray(picture.image.pixel(2, 0)), 255);
  EXPECT_EQ(picture.saturated, 3U);
  EXPECT_DOUBLE_EQ(picture.saturated_share, 3 / 8.0);
  for (const auto& [column, row, marked] : {std::tuple{2, 0, true}, {0, 1, true}, {3, 1, true}, {1, 1, false}})
    EXPECT_EQ(qAlpha(picture.mask.pixel(column, row)) == 255, marked) << column << ' ' << row;
  EXPECT_EQ(std::accumulate(picture.histogram.counts.begin(), picture.histogram.counts.end(), 0U), 8U);
  EXPECT_EQ(picture.histogram.counts.size(), 256U);
  EXPECT_EQ(picture.histogram.counts.back(), 2U);  // 4080 … 4095
  EXPECT_EQ(picture.histogram.to, 4096);
}

TEST(CameraPicture, BlocksTakeTheColoursFromTheirPlacesInEveryPattern) {
  const std::map<SensorPattern, std::vector<std::uint16_t>> places{{SensorPattern::rggb, {900, 200, 400, 100}},
                                                                   {SensorPattern::grbg, {200, 900, 100, 400}},
                                                                   {SensorPattern::gbrg, {200, 100, 900, 400}},
                                                                   {SensorPattern::bggr, {100, 200, 400, 900}}};
  for (const auto& [pattern, p] : places) {
    const auto raw = one({0, 0, p[0], p[1], 0, 0, p[2], p[3]}, pattern);
    const auto picture = make_camera_picture(raw, 0, 900, CameraColours::blocks);
    ASSERT_EQ(picture.image.size(), QSize(2, 1));
    EXPECT_EQ(pixel_text(picture, 1, 0), "column 2, row 0: R 900, G 300, B 100 DN") << static_cast<int>(pattern);
    EXPECT_EQ(qAlpha(picture.mask.pixel(1, 0)), 255);
    EXPECT_EQ(qAlpha(picture.mask.pixel(0, 0)), 0);
    EXPECT_EQ(pixel_text(picture, 2, 0), "");
  }
}

TEST(CameraPicture, EveryDepthFillsTheRange) {
  for (const int bits : {8, 10, 14, 16}) {
    const auto full = static_cast<std::uint16_t>((1 << bits) - 1);
    const auto picture = make_camera_picture(one({0, 0, 0, 0, 0, 0, 0, full}, SensorPattern::mono, bits), 0, 1e9,
                                             CameraColours::photosites);
    EXPECT_EQ(qGray(picture.image.pixel(3, 1)), 255) << bits;
    EXPECT_EQ(picture.histogram.counts.back(), 1U) << bits;
    EXPECT_TRUE(picture.mask.isNull());
  }
}

TEST(CameraPicture, ExposuresReadWell) {
  EXPECT_EQ(exposure_text(0.002), "2 ms");
  EXPECT_EQ(exposure_text(0.0005), "0.5 ms");
  EXPECT_EQ(exposure_text(0.128), "128 ms");
  EXPECT_EQ(exposure_text(1), "1 s");
  EXPECT_EQ(exposure_text(2.5), "2.5 s");
}

TEST(CameraPictureMaker, TheLatestWishWins) {
  CameraPictureMaker maker;
  std::vector<std::uint16_t> shown;
  QObject::connect(&maker, &CameraPictureMaker::made, &maker,
                   [&](const std::shared_ptr<const CameraPicture>& picture) { shown.push_back(picture->raw().dn[0]); });
  for (std::uint16_t k = 1; k <= 2000; ++k)
    maker.make({one(std::vector<std::uint16_t>(8, k), SensorPattern::mono), 0, 4000});
  EXPECT_TRUE(QTest::qWaitFor([&] { return !shown.empty() && shown.back() == 2000; }));
  EXPECT_TRUE(std::is_sorted(shown.begin(), shown.end()));
  EXPECT_LT(shown.size(), 2000U);
}

}  // namespace
}  // namespace lumifield
