#pragma once

#include <array>
#include <cstdint>

#include "renderer/picture.h"

namespace lumifield {

/// The colour of a share 0 … 1 of a scale, sRGB: OKLab lightness (Ottosson 2020) grows evenly from 0.18 to 0.96 while
/// the hue turns from violet over blue and green to yellow, so that order shows in grey print too. Below 0 and above 1:
/// the ends. NaN: grey.
std::array<std::uint8_t, 3> false_colour(double share);

/// Luminance 0.2126 R + 0.7152 G + 0.0722 B of each pixel over `top` as a colour; background black. The picture's own
/// largest luminance is the scale's end when `top` is 0.
Picture8 false_colours(const Picture& picture, double top = 0);
/// The largest luminance of the pixels with a surface, 0 when nothing is lit.
double largest_luminance(const Picture& picture);

}  // namespace lumifield
