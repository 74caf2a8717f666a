#include "renderer/false_colour.h"

#include <cmath>
#include <gtest/gtest.h>

namespace lumifield {
namespace {

/// CIE luminance of an sRGB colour, 0 … 1.
double luminance_of(const std::array<std::uint8_t, 3>& c) {
  const auto linear = [](double v) { return v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4); };
  return 0.2126 * linear(c[0] / 255.0) + 0.7152 * linear(c[1] / 255.0) + 0.0722 * linear(c[2] / 255.0);
}

TEST(FalseColour, GetsLighterAllTheWayAndSaysWhereItEnds) {
  for (int k = 0; k < 32; ++k)
    EXPECT_LT(luminance_of(false_colour(k / 32.0)), luminance_of(false_colour((k + 1) / 32.0))) << k;
  EXPECT_EQ(false_colour(-1), false_colour(0));
  EXPECT_EQ(false_colour(7), false_colour(1));
  EXPECT_EQ(false_colour(std::nan("")), (std::array<std::uint8_t, 3>{128, 128, 128}));
  // Violet at the start, yellow at the end.
  EXPECT_GT(false_colour(0.05)[2], false_colour(0.05)[1]);
  EXPECT_GT(false_colour(0.95)[0], false_colour(0.95)[2]);
}

TEST(FalseColour, ShowsLuminanceOverTheScale) {
  const Picture picture{3, 1, {1, 1, 1, 4, 4, 4, 9, 9, 9}, {1, 1, 0}, ""};
  EXPECT_DOUBLE_EQ(largest_luminance(picture), 4);
  const Picture8 own = false_colours(picture), fixed = false_colours(picture, 8);
  const auto pixel = [](const Picture8& p, std::size_t i) {
    return std::array<std::uint8_t, 3>{p.srgb[3 * i], p.srgb[3 * i + 1], p.srgb[3 * i + 2]};
  };
  EXPECT_EQ(pixel(own, 0), false_colour(0.25));
  EXPECT_EQ(pixel(own, 1), false_colour(1));
  EXPECT_EQ(pixel(fixed, 1), false_colour(0.5));
  EXPECT_EQ(pixel(own, 2), (std::array<std::uint8_t, 3>{0, 0, 0}));
}

}  // namespace
}  // namespace lumifield
