#pragma once

#include <cmath>

namespace lumifield {

/// sRGB's transfer curve, IEC 61966-2-1: from a code to linear light, both 0 … 1.
inline double srgb_decode(double encoded) {
  return encoded <= 0.04045 ? encoded / 12.92 : std::pow((encoded + 0.055) / 1.055, 2.4);
}

}  // namespace lumifield
