#include "acquisition/virtual/v4l2_pixels.h"

#include <algorithm>
#include <linux/videodev2.h>

#include "acquisition/virtual/v4l2_device.h"

namespace lumifield::virtual_bench {
namespace {

constexpr std::uint32_t y12_mipi = v4l2_fourcc('Y', '1', '2', 'P');
constexpr std::uint8_t no_colour = 128;

struct Packing {
  int bits;   ///< of a pixel that the format holds
  int group;  ///< pixels …
  int bytes;  ///< … in so many bytes
};

Packing packing_of(std::uint32_t fourcc) {
  switch (fourcc) {
    case V4L2_PIX_FMT_GREY:
    case V4L2_PIX_FMT_SRGGB8:
      return {8, 1, 1};
    case V4L2_PIX_FMT_YUYV:
      return {8, 1, 2};
    case V4L2_PIX_FMT_Y10:
    case V4L2_PIX_FMT_SRGGB10:
      return {10, 1, 2};
    case V4L2_PIX_FMT_Y10P:
    case V4L2_PIX_FMT_Y10BPACK:
    case V4L2_PIX_FMT_SRGGB10P:
      return {10, 4, 5};
    case V4L2_PIX_FMT_Y12:
    case V4L2_PIX_FMT_SRGGB12:
      return {12, 1, 2};
    case y12_mipi:
    case V4L2_PIX_FMT_SRGGB12P:
      return {12, 2, 3};
    default:
      return {16, 1, 2};
  }
}

/// The group's high bytes, then its low bits together in one byte, the first pixel's lowest.
void pack_mipi(const std::uint16_t* dn, const Packing& packing, std::uint8_t* out) {
  const int low = packing.bits - 8;
  int together = 0;
  for (int i = 0; i < packing.group; ++i) {
    out[i] = static_cast<std::uint8_t>(dn[i] >> low);
    together |= (dn[i] & ((1 << low) - 1)) << (low * i);
  }
  out[packing.group] = static_cast<std::uint8_t>(together);
}

/// Ten bits after ten bits, highest first.
void pack_stream(const std::uint16_t* dn, std::uint8_t* out) {
  std::uint64_t stream = 0;
  for (int i = 0; i < 4; ++i) stream = stream << 10 | dn[i];
  for (int i = 0; i < 5; ++i) out[i] = static_cast<std::uint8_t>(stream >> (32 - 8 * i));
}

}  // namespace

std::vector<V4l2SensorFormat> v4l2_sensor_formats(const std::string& pixel_format) {
  if (pixel_format == "BayerRG12")
    return {{V4L2_PIX_FMT_SRGGB12, "12-bit Bayer RGRG/GBGB"}, {V4L2_PIX_FMT_SRGGB12P, "12-bit Bayer RGRG/GBGB Packed"},
            {V4L2_PIX_FMT_SRGGB10, "10-bit Bayer RGRG/GBGB"}, {V4L2_PIX_FMT_SRGGB10P, "10-bit Bayer RGRG/GBGB Packed"},
            {V4L2_PIX_FMT_SRGGB8, "8-bit Bayer RGRG/GBGB"},   {V4L2_PIX_FMT_MJPEG, "Motion-JPEG", true}};
  std::vector<V4l2SensorFormat> formats{{V4L2_PIX_FMT_Y12, "12-bit Greyscale"},
                                        {y12_mipi, "12-bit Greyscale (MIPI Packed)"},
                                        {V4L2_PIX_FMT_Y10, "10-bit Greyscale"},
                                        {V4L2_PIX_FMT_Y10P, "10-bit Greyscale (MIPI Packed)"},
                                        {V4L2_PIX_FMT_Y10BPACK, "10-bit Greyscale (Packed)"},
                                        {V4L2_PIX_FMT_GREY, "8-bit Greyscale"},
                                        {V4L2_PIX_FMT_YUYV, "YUYV 4:2:2"},
                                        {V4L2_PIX_FMT_MJPEG, "Motion-JPEG", true}};
  if (pixel_format == "Mono16") formats.insert(formats.begin(), {V4L2_PIX_FMT_Y16, "16-bit Greyscale"});
  return formats;
}

std::size_t packed_row_bytes(std::uint32_t fourcc, int width_px) {
  const Packing packing = packing_of(fourcc);
  return static_cast<std::size_t>((width_px + packing.group - 1) / packing.group * packing.bytes);
}

void pack(std::span<const std::uint16_t> dn, int bits, std::uint32_t fourcc, int width_px,
          std::span<std::uint8_t> out) {
  const Packing packing = packing_of(fourcc);
  const std::size_t stride = packed_row_bytes(fourcc, width_px), width = static_cast<std::size_t>(width_px);
  for (std::size_t first = 0, row = 0; first < dn.size(); first += width, row += stride)
    for (std::size_t x = 0; x < width; x += static_cast<std::size_t>(packing.group)) {
      std::uint16_t group[4] = {};
      for (std::size_t i = 0; i < static_cast<std::size_t>(packing.group) && x + i < width; ++i)
        group[i] = static_cast<std::uint16_t>(dn[first + x + i] >> std::max(0, bits - packing.bits));
      std::uint8_t* const at = out.data() + row + x / static_cast<std::size_t>(packing.group) * packing.bytes;
      if (fourcc == V4L2_PIX_FMT_Y10BPACK) {
        pack_stream(group, at);
      } else if (packing.group > 1) {
        pack_mipi(group, packing, at);
      } else {
        at[0] = static_cast<std::uint8_t>(group[0]);
        if (packing.bytes == 2)
          at[1] = fourcc == V4L2_PIX_FMT_YUYV ? no_colour : static_cast<std::uint8_t>(group[0] >> 8);
      }
    }
}

}  // namespace lumifield::virtual_bench
