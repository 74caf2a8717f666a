#include "acquisition/virtual/genicam_pixels.h"

#include <algorithm>
#include <map>

namespace lumifield::virtual_bench {
namespace {

using Packing = GenicamPixelFormat::Packing;

// The codes as the convention lists them.
const std::map<std::string, GenicamPixelFormat> formats = {
    {"Mono8", {0x01080001, 8, Packing::bytes}},
    {"Mono10", {0x01100003, 10, Packing::words}},
    {"Mono10Packed", {0x010c0004, 10, Packing::gige}},
    {"Mono10p", {0x010a0046, 10, Packing::lsb_first}},
    {"Mono12", {0x01100005, 12, Packing::words}},
    {"Mono12Packed", {0x010c0006, 12, Packing::gige}},
    {"Mono12p", {0x010c0047, 12, Packing::lsb_first}},
    {"Mono14", {0x01100025, 14, Packing::words}},
    {"Mono16", {0x01100007, 16, Packing::words}},
    {"BayerGR8", {0x01080008, 8, Packing::bytes}},
    {"BayerRG8", {0x01080009, 8, Packing::bytes}},
    {"BayerGB8", {0x0108000a, 8, Packing::bytes}},
    {"BayerBG8", {0x0108000b, 8, Packing::bytes}},
    {"BayerGR10", {0x0110000c, 10, Packing::words}},
    {"BayerRG10", {0x0110000d, 10, Packing::words}},
    {"BayerGB10", {0x0110000e, 10, Packing::words}},
    {"BayerBG10", {0x0110000f, 10, Packing::words}},
    {"BayerGR12", {0x01100010, 12, Packing::words}},
    {"BayerRG12", {0x01100011, 12, Packing::words}},
    {"BayerGB12", {0x01100012, 12, Packing::words}},
    {"BayerBG12", {0x01100013, 12, Packing::words}},
    {"BayerGR16", {0x0110002e, 16, Packing::words}},
    {"BayerRG16", {0x0110002f, 16, Packing::words}},
    {"BayerGB16", {0x01100030, 16, Packing::words}},
    {"BayerBG16", {0x01100031, 16, Packing::words}},
    {"BayerGR10Packed", {0x010c0026, 10, Packing::gige}},
    {"BayerRG10Packed", {0x010c0027, 10, Packing::gige}},
    {"BayerGB10Packed", {0x010c0028, 10, Packing::gige}},
    {"BayerBG10Packed", {0x010c0029, 10, Packing::gige}},
    {"BayerGR12Packed", {0x010c002a, 12, Packing::gige}},
    {"BayerRG12Packed", {0x010c002b, 12, Packing::gige}},
    {"BayerGB12Packed", {0x010c002c, 12, Packing::gige}},
    {"BayerBG12Packed", {0x010c002d, 12, Packing::gige}},
    {"BayerBG10p", {0x010a0052, 10, Packing::lsb_first}},
    {"BayerBG12p", {0x010c0053, 12, Packing::lsb_first}},
    {"BayerGB10p", {0x010a0054, 10, Packing::lsb_first}},
    {"BayerGB12p", {0x010c0055, 12, Packing::lsb_first}},
    {"BayerGR10p", {0x010a0056, 10, Packing::lsb_first}},
    {"BayerGR12p", {0x010c0057, 12, Packing::lsb_first}},
    {"BayerRG10p", {0x010a0058, 10, Packing::lsb_first}},
    {"BayerRG12p", {0x010c0059, 12, Packing::lsb_first}},
    {"RGB8", {0x02180014, 8, Packing::rgb}},
    {"BGR8", {0x02180015, 8, Packing::bgr}},
};

/// One pixel's three: those of the four photosites from it to the right and below; of both greens its own, or the right
/// one.
void make_colours_up(std::span<const std::uint16_t> dn, std::size_t width, std::size_t pixel, bool red_first,
                     std::span<std::uint8_t> out) {
  const std::size_t rows = dn.size() / width;
  const auto give = [&](std::size_t y, std::size_t x) {
    y = y < rows ? y : rows - 2, x = x < width ? x : width - 2;
    const std::size_t colour = y % 2 + x % 2;
    out[3 * pixel + (red_first ? colour : 2 - colour)] = std::uint8_t(dn[y * width + x]);
  };
  const std::size_t y = pixel / width, x = pixel % width;
  give(y + 1, x + 1), give(y + 1, x), give(y, x + 1), give(y, x);
}

}  // namespace

std::optional<GenicamPixelFormat> genicam_pixel_format(const std::string& name) {
  const auto found = formats.find(name);
  return found == formats.end() ? std::nullopt : std::optional(found->second);
}

void pack(std::span<const std::uint16_t> dn, int width_px, const GenicamPixelFormat& format,
          std::span<std::uint8_t> out) {
  std::ranges::fill(out, std::uint8_t{0});
  const unsigned mask = (1u << format.bits) - 1;
  const auto each = [&](auto put) {
    for (std::size_t i = 0; i < dn.size(); ++i) put(i, dn[i] & mask);
  };
  switch (format.packing) {
    case Packing::bytes:
      return each([&](std::size_t i, unsigned value) { out[i] = std::uint8_t(value); });
    case Packing::words:
      return each([&](std::size_t i, unsigned value) {
        out[2 * i] = std::uint8_t(value), out[2 * i + 1] = std::uint8_t(value >> 8);
      });
    case Packing::gige: {
      const int high = format.bits - 8;  // bits of a group's middle byte, per photosite
      return each([&](std::size_t i, unsigned value) {
        const std::size_t group = i / 2 * 3;
        out[i % 2 == 0 ? group : group + 2] = std::uint8_t(value >> high);
        out[group + 1] |= std::uint8_t((value & ((1u << high) - 1)) << (i % 2 * 4));
      });
    }
    case Packing::lsb_first:
      return each([&](std::size_t i, unsigned value) {
        for (int bit = 0; bit < format.bits; ++bit) {
          const std::size_t at = i * std::size_t(format.bits) + std::size_t(bit);
          out[at / 8] |= std::uint8_t((value >> bit & 1) << at % 8);
        }
      });
    case Packing::rgb:
    case Packing::bgr:
      return each([&](std::size_t i, unsigned) {
        make_colours_up(dn, std::size_t(width_px), i, format.packing == Packing::rgb, out);
      });
  }
}

}  // namespace lumifield::virtual_bench
