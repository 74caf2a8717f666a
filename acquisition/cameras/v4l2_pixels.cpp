#include "acquisition/cameras/v4l2_pixels.h"

#include <algorithm>
#include <cassert>
#include <linux/videodev2.h>

namespace lumifield {
namespace {

// Newer than Debian 12's kernel headers.
constexpr std::uint32_t y12_mipi = v4l2_fourcc('Y', '1', '2', 'P');

using enum SensorPattern;
using enum PixelPacking;

constexpr V4l2PixelFormat formats[] = {
    {V4L2_PIX_FMT_GREY, "Mono8", 8, mono, bytes},           {V4L2_PIX_FMT_Y10, "Mono10", 10, mono, words},
    {V4L2_PIX_FMT_Y10P, "Mono10", 10, mono, mipi10},        {V4L2_PIX_FMT_Y10BPACK, "Mono10", 10, mono, bits10},
    {V4L2_PIX_FMT_Y12, "Mono12", 12, mono, words},          {y12_mipi, "Mono12", 12, mono, mipi12},
    {V4L2_PIX_FMT_Y14, "Mono14", 14, mono, words},          {V4L2_PIX_FMT_Y16, "Mono16", 16, mono, words},
    {V4L2_PIX_FMT_YUYV, "YUV422_8", 8, mono, luma_first},   {V4L2_PIX_FMT_UYVY, "YUV422_8_UYVY", 8, mono, luma_second},
    {V4L2_PIX_FMT_SRGGB8, "BayerRG8", 8, rggb, bytes},      {V4L2_PIX_FMT_SGRBG8, "BayerGR8", 8, grbg, bytes},
    {V4L2_PIX_FMT_SGBRG8, "BayerGB8", 8, gbrg, bytes},      {V4L2_PIX_FMT_SBGGR8, "BayerBG8", 8, bggr, bytes},
    {V4L2_PIX_FMT_SRGGB10, "BayerRG10", 10, rggb, words},   {V4L2_PIX_FMT_SGRBG10, "BayerGR10", 10, grbg, words},
    {V4L2_PIX_FMT_SGBRG10, "BayerGB10", 10, gbrg, words},   {V4L2_PIX_FMT_SBGGR10, "BayerBG10", 10, bggr, words},
    {V4L2_PIX_FMT_SRGGB10P, "BayerRG10", 10, rggb, mipi10}, {V4L2_PIX_FMT_SGRBG10P, "BayerGR10", 10, grbg, mipi10},
    {V4L2_PIX_FMT_SGBRG10P, "BayerGB10", 10, gbrg, mipi10}, {V4L2_PIX_FMT_SBGGR10P, "BayerBG10", 10, bggr, mipi10},
    {V4L2_PIX_FMT_SRGGB12, "BayerRG12", 12, rggb, words},   {V4L2_PIX_FMT_SGRBG12, "BayerGR12", 12, grbg, words},
    {V4L2_PIX_FMT_SGBRG12, "BayerGB12", 12, gbrg, words},   {V4L2_PIX_FMT_SBGGR12, "BayerBG12", 12, bggr, words},
    {V4L2_PIX_FMT_SRGGB12P, "BayerRG12", 12, rggb, mipi12}, {V4L2_PIX_FMT_SGRBG12P, "BayerGR12", 12, grbg, mipi12},
    {V4L2_PIX_FMT_SGBRG12P, "BayerGB12", 12, gbrg, mipi12}, {V4L2_PIX_FMT_SBGGR12P, "BayerBG12", 12, bggr, mipi12},
    {V4L2_PIX_FMT_SRGGB16, "BayerRG16", 16, rggb, words},   {V4L2_PIX_FMT_SGRBG16, "BayerGR16", 16, grbg, words},
    {V4L2_PIX_FMT_SGBRG16, "BayerGB16", 16, gbrg, words},   {V4L2_PIX_FMT_SBGGR16, "BayerBG16", 16, bggr, words},
};

std::uint16_t photosite(const std::uint8_t* row, int x, PixelPacking packing) {
  const auto dn = [](int value) { return static_cast<std::uint16_t>(value); };
  switch (packing) {
    case bytes:
      return row[x];
    case words:
      return dn(row[2 * x] | row[2 * x + 1] << 8);
    case luma_first:
      return row[2 * x];
    case luma_second:
      return row[2 * x + 1];
    case mipi10: {
      const std::uint8_t* four = row + x / 4 * 5;
      return dn(four[x % 4] << 2 | (four[4] >> 2 * (x % 4) & 3));
    }
    case mipi12: {
      const std::uint8_t* two = row + x / 2 * 3;
      return dn(two[x % 2] << 4 | (two[2] >> 4 * (x % 2) & 15));
    }
    case bits10: {
      const std::uint8_t* pair = row + x / 4 * 5 + x % 4;
      return dn((pair[0] << 8 | pair[1]) >> (6 - 2 * (x % 4)) & 1023);
    }
  }
  return 0;
}

}  // namespace

std::size_t V4l2PixelFormat::row_bytes(int width_px) const {
  const auto width = static_cast<std::size_t>(width_px);
  switch (packing) {
    case bytes:
      return width;
    case mipi10:
    case bits10:
      return (width + 3) / 4 * 5;
    case mipi12:
      return (width + 1) / 2 * 3;
    default:
      return 2 * width;
  }
}

std::optional<V4l2PixelFormat> v4l2_pixel_format(std::uint32_t fourcc) {
  const auto* const found = std::ranges::find(formats, fourcc, &V4l2PixelFormat::fourcc);
  return found == std::end(formats) ? std::nullopt : std::optional(*found);
}

std::string fourcc_text(std::uint32_t fourcc) {
  std::string text;
  for (int shift = 0; shift < 32; shift += 8) {
    const char letter = static_cast<char>(fourcc >> shift & 0x7f);
    text += letter >= ' ' && letter != 0x7f ? letter : '?';
  }
  return text;
}

std::vector<std::uint16_t> unpack(std::span<const std::uint8_t> bytes_of_frame, std::size_t stride, int width_px,
                                  int height_px, PixelPacking packing) {
  std::vector<std::uint16_t> dn(static_cast<std::size_t>(width_px) * height_px);
  assert(bytes_of_frame.size() >= stride * static_cast<std::size_t>(height_px - 1));
  auto out = dn.begin();
  for (int y = 0; y < height_px; ++y) {
    const std::uint8_t* row = bytes_of_frame.data() + stride * static_cast<std::size_t>(y);
    for (int x = 0; x < width_px; ++x) *out++ = photosite(row, x, packing);
  }
  return dn;
}

}  // namespace lumifield
