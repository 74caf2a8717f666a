#include "acquisition/cameras/pixel_layout.h"

#include <cassert>
#include <utility>

namespace lumifield {
namespace {

using Packing = PixelLayout::Packing;

struct Depth {
  std::string_view name;
  int bits;
  Packing packing = Packing::whole_bytes;
};
constexpr Depth depths[] = {{"8", 8},
                            {"10", 10},
                            {"10Packed", 10, Packing::pairs},
                            {"10p", 10, Packing::lsb_first},
                            {"12", 12},
                            {"12Packed", 12, Packing::pairs},
                            {"12p", 12, Packing::lsb_first},
                            {"14", 14},
                            {"16", 16}};

void unpack_whole(std::span<const std::uint8_t> bytes, bool wide, std::vector<std::uint16_t>& dn) {
  for (std::size_t i = 0; i < dn.size(); ++i)
    dn[i] = wide ? static_cast<std::uint16_t>(bytes[2 * i] | bytes[2 * i + 1] << 8) : bytes[i];
}

void unpack_pairs(std::span<const std::uint8_t> bytes, int bits, std::vector<std::uint16_t>& dn) {
  const int low_bits = bits - 8;
  const unsigned low_mask = (1u << low_bits) - 1;
  for (std::size_t i = 0; i < dn.size(); ++i) {
    const std::uint8_t* const group = bytes.data() + i / 2 * 3;
    const unsigned high = i % 2 == 0 ? group[0] : group[2], low = group[1] >> (i % 2 == 0 ? 0 : 4);
    dn[i] = static_cast<std::uint16_t>(high << low_bits | (low & low_mask));
  }
}

void unpack_bits(std::span<const std::uint8_t> bytes, int bits, std::vector<std::uint16_t>& dn) {
  const std::uint32_t mask = (1u << bits) - 1;
  std::uint32_t held = 0;
  int held_bits = 0;
  std::size_t next = 0;
  for (std::uint16_t& value : dn) {
    for (; held_bits < bits; held_bits += 8) held |= static_cast<std::uint32_t>(bytes[next++]) << held_bits;
    value = static_cast<std::uint16_t>(held & mask);
    held >>= bits;
    held_bits -= bits;
  }
}

/// Even rows R G R G …, odd ones G B G B ….
void pick_colours(std::span<const std::uint8_t> bytes, bool red_first, std::size_t width,
                  std::vector<std::uint16_t>& dn) {
  for (std::size_t i = 0; i < dn.size(); ++i) {
    const std::size_t colour = i % width % 2 + i / width % 2;
    dn[i] = bytes[3 * i + (red_first ? colour : 2 - colour)];
  }
}

}  // namespace

std::size_t PixelLayout::bits_per_pixel() const {
  switch (packing) {
    case Packing::pairs:
      return 12;
    case Packing::lsb_first:
      return static_cast<std::size_t>(bits);
    case Packing::rgb:
    case Packing::bgr:
      return 24;
    case Packing::whole_bytes:
      break;
  }
  return bits > 8 ? 16 : 8;
}

std::optional<PixelLayout> pixel_layout(std::string_view genicam_name) {
  constexpr std::pair<std::string_view, SensorPattern> families[] = {{"Mono", SensorPattern::mono},
                                                                     {"BayerRG", SensorPattern::rggb},
                                                                     {"BayerGR", SensorPattern::grbg},
                                                                     {"BayerGB", SensorPattern::gbrg},
                                                                     {"BayerBG", SensorPattern::bggr}};
  for (const auto& [family, pattern] : families)
    for (const Depth& depth : depths)
      if (genicam_name.starts_with(family) && genicam_name.substr(family.size()) == depth.name)
        return PixelLayout{depth.bits, pattern, depth.packing};
  if (genicam_name == "RGB8") return PixelLayout{8, SensorPattern::rggb, Packing::rgb};
  if (genicam_name == "BGR8") return PixelLayout{8, SensorPattern::rggb, Packing::bgr};
  return std::nullopt;
}

std::vector<std::uint16_t> unpack(std::span<const std::uint8_t> bytes, int width_px, int height_px,
                                  const PixelLayout& layout) {
  const std::size_t width = static_cast<std::size_t>(width_px), pixels = width * static_cast<std::size_t>(height_px);
  assert(bytes.size() >= layout.frame_bytes(pixels));
  std::vector<std::uint16_t> dn(pixels);
  switch (layout.packing) {
    case Packing::whole_bytes:
      unpack_whole(bytes, layout.bits > 8, dn);
      break;
    case Packing::pairs:
      unpack_pairs(bytes, layout.bits, dn);
      break;
    case Packing::lsb_first:
      unpack_bits(bytes, layout.bits, dn);
      break;
    case Packing::rgb:
    case Packing::bgr:
      pick_colours(bytes, layout.packing == Packing::rgb, width, dn);
      break;
  }
  return dn;
}

}  // namespace lumifield
