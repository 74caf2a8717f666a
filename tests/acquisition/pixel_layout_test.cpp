#include "acquisition/cameras/pixel_layout.h"

#include <array>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace lumifield {
namespace {

using testing::ElementsAre;
using Packing = PixelLayout::Packing;

TEST(PixelLayout, KnowsWhatCanBeMeasuredWith) {
  EXPECT_EQ(pixel_layout("Mono12")->bits, 12);
  EXPECT_EQ(pixel_layout("Mono12")->bits_per_pixel(), 16u);
  EXPECT_EQ(pixel_layout("Mono12p")->bits_per_pixel(), 12u);
  EXPECT_EQ(pixel_layout("Mono10Packed")->bits_per_pixel(), 12u);
  EXPECT_EQ(pixel_layout("Mono10p")->frame_bytes(5), 7u);
  EXPECT_EQ(pixel_layout("Mono12Packed")->frame_bytes(5), 8u);
  EXPECT_EQ(pixel_layout("BayerRG12")->pattern, SensorPattern::rggb);
  EXPECT_EQ(pixel_layout("BayerGB10p")->pattern, SensorPattern::gbrg);
  EXPECT_EQ(pixel_layout("RGB8")->pattern, SensorPattern::rggb);
  EXPECT_EQ(pixel_layout("BGR8")->frame_bytes(5), 15u);
  for (const char* name : {"", "Mono", "Mono12packed", "Mono12P", "Mono8p", "Mono16Packed", "RGB10", "RGB8p", "BayerRG",
                           "mono8", "Mono9", "Bayer8", "Mono12Packedp"})
    EXPECT_FALSE(pixel_layout(name)) << name;
}

TEST(PixelLayout, UnpacksWholeBytes) {
  const std::array<std::uint8_t, 4> bytes{0x34, 0x02, 0xff, 0x0f};
  EXPECT_THAT(unpack(bytes, 2, 1, {12, SensorPattern::mono}), ElementsAre(0x234, 0xfff));
  EXPECT_THAT(unpack(bytes, 4, 1, {8, SensorPattern::mono}), ElementsAre(0x34, 0x02, 0xff, 0x0f));
}

// The bytes as the conventions draw them.
TEST(PixelLayout, UnpacksGigEVisionsPairs) {
  const std::array<std::uint8_t, 5> twelve{0xab, 0xfc, 0xde, 0x12, 0x03};
  EXPECT_THAT(unpack(twelve, 3, 1, {12, SensorPattern::mono, Packing::pairs}), ElementsAre(0xabc, 0xdef, 0x123));
  const std::array<std::uint8_t, 5> ten{0xff, 0x21, 0x80, 0x01, 0x03};
  EXPECT_THAT(unpack(ten, 3, 1, {10, SensorPattern::mono, Packing::pairs}), ElementsAre(0x3fd, 0x202, 0x007));
}

TEST(PixelLayout, UnpacksBitsLowestFirst) {
  const std::array<std::uint8_t, 5> twelve{0xbc, 0xfa, 0xde, 0x23, 0x01};
  EXPECT_THAT(unpack(twelve, 3, 1, {12, SensorPattern::mono, Packing::lsb_first}), ElementsAre(0xabc, 0xdef, 0x123));
  // 1, 2, 0x3ff, 0x155, 0x200: ten bits each, from the lowest bit of the first byte on.
  const std::array<std::uint8_t, 7> ten{0x01, 0x08, 0xf0, 0x7f, 0x55, 0x00, 0x02};
  EXPECT_THAT(unpack(ten, 5, 1, {10, SensorPattern::mono, Packing::lsb_first}), ElementsAre(1, 2, 0x3ff, 0x155, 0x200));
}

TEST(PixelLayout, TakesOfThreeColoursThatOfABayerSensorsPhotosite) {
  const std::array<std::uint8_t, 18> bytes{1, 2, 3, 4, 5, 6, 7, 8, 9, 11, 12, 13, 14, 15, 16, 17, 18, 19};
  EXPECT_THAT(unpack(bytes, 3, 2, *pixel_layout("RGB8")), ElementsAre(1, 5, 7, 12, 16, 18));
  EXPECT_THAT(unpack(bytes, 3, 2, *pixel_layout("BGR8")), ElementsAre(3, 5, 9, 12, 14, 18));
}

}  // namespace
}  // namespace lumifield
