#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "luminaire/raw_image.h"

namespace lumifield {

/// How a GenICam pixel format lies in memory: one photosite in 8 bits, or right-aligned in 16, little endian. Packed
/// formats are not taken: every camera that offers one offers its unpacked twin.
/// Source: EMVA Pixel Format Naming Convention 2.0. Value type.
struct PixelLayout {
  int bits = 8;
  SensorPattern pattern = SensorPattern::mono;

  std::size_t bytes_per_pixel() const { return bits > 8 ? 2 : 1; }
};

/// `Mono8` … `Mono16`, `BayerRG8` … `BayerBG16`; nothing for other formats.
std::optional<PixelLayout> pixel_layout(std::string_view genicam_name);

/// DN of all pixels; `bytes` has at least pixels · bytes_per_pixel().
std::vector<std::uint16_t> unpack(std::span<const std::uint8_t> bytes, std::size_t pixels, const PixelLayout& layout);

}  // namespace lumifield
