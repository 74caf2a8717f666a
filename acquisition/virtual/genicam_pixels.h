#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

namespace lumifield::virtual_bench {

/// One GenICam pixel format as the camera sends it: photosites of `bits` in a byte each, in two bytes, low one first,
/// in groups of GigE Vision's own packing (Mono10Packed: high bits, a byte of both low bits, high bits), or bit after
/// bit, lowest first (Mono10p); or, of a sensor RGGB, three bytes a pixel: its own colour, and the others as the
/// photosites beside it have them (RGB8, BGR8). Source: EMVA Pixel Format Naming Convention 2.1; GigE Vision 1.2.
struct GenicamPixelFormat {
  enum class Packing { bytes, words, gige, lsb_first, rgb, bgr };

  std::uint32_t code = 0;  ///< PFNC; bits per pixel in its third byte
  int bits = 8;
  Packing packing = Packing::bytes;

  int bits_per_pixel() const { return static_cast<int>(code >> 16 & 0xff); }
  std::size_t bytes_of(std::size_t pixels) const {
    return (pixels * static_cast<std::size_t>(bits_per_pixel()) + 7) / 8;
  }
};

/// Mono and Bayer of all four patterns, each with 8, 10, 12 and 16 bits, 10Packed, 12Packed, 10p and 12p; Mono14; RGB8,
/// BGR8.
std::optional<GenicamPixelFormat> genicam_pixel_format(const std::string& name);

/// Right-aligned DN, of which the format's lowest bits are sent.
void pack(std::span<const std::uint16_t> dn, int width_px, const GenicamPixelFormat& format,
          std::span<std::uint8_t> out);

}  // namespace lumifield::virtual_bench
