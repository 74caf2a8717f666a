#pragma once

#include <array>

#include "renderer/picture.h"

namespace lumifield {

/// CIE 1976 L*a*b* of an sRGB colour (IEC 61966-2-1, white D65 2°).
std::array<double, 3> lab_of_srgb(std::uint8_t r, std::uint8_t g, std::uint8_t b);

/// Mean over the pixels of ΔE*ab = √(ΔL² + Δa² + Δb²), the paper's metric on tone-mapped pictures. Both of one size.
double mean_lab_delta_e(const Picture8& a, const Picture8& b);

}  // namespace lumifield
