#include "acquisition/cameras/v4l2_pixels.h"

#include <array>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <linux/videodev2.h>

#include "acquisition/cameras/v4l2_freshness.h"

namespace lumifield {
namespace {

using testing::ElementsAre;

// By the tables of the Linux Media Subsystem Documentation.
TEST(V4l2Pixels, PackedFormatsAreThoseOfTheirTables) {
  const std::array<std::uint8_t, 5> mipi10{0xff, 0x00, 0x80, 0x01, 0b11'10'01'00};
  EXPECT_THAT(unpack(mipi10, 5, 4, 1, PixelPacking::mipi10), ElementsAre(0x3fc, 0x001, 0x202, 0x007));
  const std::array<std::uint8_t, 3> mipi12{0xab, 0x12, 0x3c};
  EXPECT_THAT(unpack(mipi12, 3, 2, 1, PixelPacking::mipi12), ElementsAre(0xabc, 0x123));
  // 1111111111 0000000001 1000000000 0101010101
  const std::array<std::uint8_t, 5> stream{0xff, 0xc0, 0x18, 0x01, 0x55};
  EXPECT_THAT(unpack(stream, 5, 4, 1, PixelPacking::bits10), ElementsAre(0x3ff, 0x001, 0x200, 0x155));
  const std::array<std::uint8_t, 4> four{1, 2, 3, 4};
  EXPECT_THAT(unpack(four, 4, 2, 1, PixelPacking::luma_first), ElementsAre(1, 3));
  EXPECT_THAT(unpack(four, 4, 2, 1, PixelPacking::luma_second), ElementsAre(2, 4));
  EXPECT_THAT(unpack(four, 4, 2, 1, PixelPacking::words), ElementsAre(0x201, 0x403));
}

TEST(V4l2Pixels, RowsMayBeLongerThanTheirPhotosites) {
  const std::array<std::uint8_t, 5> rows{1, 2, 99, 3, 4};  // the last row ends with its photosites
  EXPECT_THAT(unpack(rows, 3, 2, 2, PixelPacking::bytes), ElementsAre(1, 2, 3, 4));
}

TEST(V4l2Pixels, CompressedFormatsAreNotKnown) {
  EXPECT_FALSE(v4l2_pixel_format(V4L2_PIX_FMT_MJPEG));
  EXPECT_FALSE(v4l2_pixel_format(V4L2_PIX_FMT_H264));
  EXPECT_EQ(v4l2_pixel_format(V4L2_PIX_FMT_SGBRG12P)->name, "BayerGB12");
  EXPECT_EQ(v4l2_pixel_format(V4L2_PIX_FMT_SGBRG12P)->row_bytes(6), 9u);
  EXPECT_EQ(fourcc_text(V4L2_PIX_FMT_MJPEG), "MJPG");
}

TEST(V4l2Freshness, AFrameCountsThatBeganAfterTheQuestion) {
  V4l2Freshness fresh(0.02);
  fresh.ask(100, 0.05, 0.01, false);
  EXPECT_FALSE(fresh.counts(100.069)) << "began before, or its read-out was short: nobody can tell";
  EXPECT_TRUE(fresh.counts(100.07));
  fresh.ask(200, 0.05, 0.04, false);
  EXPECT_FALSE(fresh.counts(200.089)) << "the frame interval bounds the read-out";
  EXPECT_TRUE(fresh.counts(200.091));
}

TEST(V4l2Freshness, AfterAChangeFramesArePassedOver) {
  V4l2Freshness fresh(0);
  fresh.ask(100, 0.01, 0.01, true);
  EXPECT_FALSE(fresh.counts(100.01)) << "before it, and not one of those passed over";
  for (int k = 0; k < V4l2Freshness::frames_passed_over; ++k) EXPECT_FALSE(fresh.counts(100.1 + k));
  EXPECT_TRUE(fresh.counts(104));
  fresh.ask(105, 0.01, 0.01, false);
  EXPECT_TRUE(fresh.counts(106)) << "no change, nothing is passed over";
}

}  // namespace
}  // namespace lumifield
