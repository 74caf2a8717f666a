#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>

namespace lumifield {

/// Three signed floats in 8 bits each with a shared exponent (Granier et al. 2003, Sec. 4.2, with the offset that 8
/// bits have):
///
///     e = ⌊log₂ max(|R|, |G|, |B|)⌋ + 2, from −126 to 129,   byte = round(255·c·2^−e + 128),   exponent's byte = e +
///     126
///
/// The offset 128/255 is a byte, so that a channel of 0 stays 0; with ½ it would come back as a cast of colour. The
/// greatest channel has from 64 to 127 steps of its own size: off by 0.78 % at most. Magnitudes below 2^−126 are 0,
/// which is (128, 128, 128, 0). A mantissa's byte is never 0 but in the mark of what is not finite, (0, 0, 0, 255).
/// srgbe() and from_srgbe() of spot_shaders.h are the same. Value types; reentrant.
using Srgbe = std::array<std::uint8_t, 4>;

inline constexpr Srgbe srgbe_not_finite = {0, 0, 0, 255};

/// None of NaN and Inf.
inline std::optional<Srgbe> to_srgbe(const std::array<float, 3>& colour) {
  float most = 0;
  for (const float c : colour) {
    if (!std::isfinite(c)) return std::nullopt;
    most = std::max(most, std::abs(c));
  }
  if (most < std::numeric_limits<float>::min()) return Srgbe{128, 128, 128, 0};
  int exponent = 0;
  std::frexp(most, &exponent);  // most = m·2^exponent, ½ ≤ m < 1
  const int e = std::clamp(exponent + 1, -126, 129);
  Srgbe bytes{};
  for (std::size_t k = 0; k < 3; ++k)
    bytes[k] =
        static_cast<std::uint8_t>(std::clamp(std::floor(255 * std::ldexp(colour[k], -e) + 128.5F), 1.0F, 255.0F));
  bytes[3] = static_cast<std::uint8_t>(e + 126);
  return bytes;
}

/// NaN of the mark.
inline std::array<float, 3> from_srgbe(const Srgbe& bytes) {
  if (bytes == srgbe_not_finite) {
    constexpr float nan = std::numeric_limits<float>::quiet_NaN();
    return {nan, nan, nan};
  }
  const int e = bytes[3] - 126;
  std::array<float, 3> colour{};
  for (std::size_t k = 0; k < 3; ++k) colour[k] = std::ldexp(static_cast<float>(bytes[k] - 128) / 255.0F, e);
  return colour;
}

}  // namespace lumifield
