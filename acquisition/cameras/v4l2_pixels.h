#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "luminaire/raw_image.h"

namespace lumifield {

/// How a row of photosites lies in memory. `mipi10` and `mipi12`: the high bytes of four or two photosites, then a byte
/// of their low bits, the first in the lowest; `bits10`: ten bits after ten bits, highest first; `luma_first` and
/// `luma_second`: every other byte is colour and left out.
enum class PixelPacking { bytes, words, mipi10, mipi12, bits10, luma_first, luma_second };

/// One uncompressed V4L2 format. Value type.
/// Source: Linux Media Subsystem Documentation, Image Formats.
struct V4l2PixelFormat {
  std::uint32_t fourcc = 0;
  std::string_view name;  ///< GenICam spelling of the same DN: "Mono12" for Y12 and Y12P alike
  int bits = 8;
  SensorPattern pattern = SensorPattern::mono;
  PixelPacking packing = PixelPacking::bytes;

  std::size_t row_bytes(int width_px) const;
};

/// What is known of a format; nothing for the others, all compressed ones among them.
std::optional<V4l2PixelFormat> v4l2_pixel_format(std::uint32_t fourcc);

/// "Y12 ", "MJPG".
std::string fourcc_text(std::uint32_t fourcc);

/// DN row-major; each row of `bytes` takes `stride` bytes, the last may end with its photosites.
std::vector<std::uint16_t> unpack(std::span<const std::uint8_t> bytes, std::size_t stride, int width_px, int height_px,
                                  PixelPacking packing);

}  // namespace lumifield
