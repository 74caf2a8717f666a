#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "luminaire/raw_image.h"

namespace lumifield {

/// How a GenICam pixel format lies in memory: one photosite in 8 bits; right-aligned in 16, little endian; two in three
/// bytes, GigE Vision's own packing: the high bits of the first, both low ones (the first's in bits 0 …, the second's
/// in 4 …), the high bits of the second; or bit after bit, lowest first, from row to row. Or three colours of every
/// pixel, of which one is taken: that of the photosite that a Bayer sensor RGGB has there. A camera with three sensors
/// measures it there; one that makes its colours up from a Bayer sensor's does so at some pixels, and at the others
/// gives a mean of neighbours: a picture blurred by a pixel, whose variance is overstated.
/// Source: EMVA Pixel Format Naming Convention 2.1; GigE Vision 1.2, "Packed" formats. Value type.
struct PixelLayout {
  enum class Packing { whole_bytes, pairs, lsb_first, rgb, bgr };

  int bits = 8;
  SensorPattern pattern = SensorPattern::mono;
  Packing packing = Packing::whole_bytes;

  std::size_t bits_per_pixel() const;
  std::size_t frame_bytes(std::size_t pixels) const { return (pixels * bits_per_pixel() + 7) / 8; }
};

/// `Mono8` … `Mono16`, `BayerRG8` … `BayerBG16`, and of those with 10 and 12 bits `Mono12Packed` and `Mono12p`; `RGB8`
/// and `BGR8`; nothing for other formats.
std::optional<PixelLayout> pixel_layout(std::string_view genicam_name);

/// DN of all pixels, row by row; `bytes` has at least frame_bytes(width_px · height_px).
std::vector<std::uint16_t> unpack(std::span<const std::uint8_t> bytes, int width_px, int height_px,
                                  const PixelLayout& layout);

}  // namespace lumifield
