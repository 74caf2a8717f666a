#include "acquisition/cameras/pixel_layout.h"

#include <cassert>
#include <utility>

namespace lumifield {

std::optional<PixelLayout> pixel_layout(std::string_view genicam_name) {
  constexpr std::pair<std::string_view, SensorPattern> families[] = {{"Mono", SensorPattern::mono},
                                                                     {"BayerRG", SensorPattern::rggb},
                                                                     {"BayerGR", SensorPattern::grbg},
                                                                     {"BayerGB", SensorPattern::gbrg},
                                                                     {"BayerBG", SensorPattern::bggr}};
  constexpr std::pair<std::string_view, int> depths[] = {{"8", 8}, {"10", 10}, {"12", 12}, {"14", 14}, {"16", 16}};
  for (const auto& [family, pattern] : families)
    for (const auto& [depth, bits] : depths)
      if (genicam_name.starts_with(family) && genicam_name.substr(family.size()) == depth)
        return PixelLayout{bits, pattern};
  return std::nullopt;
}

std::vector<std::uint16_t> unpack(std::span<const std::uint8_t> bytes, std::size_t pixels, const PixelLayout& layout) {
  assert(bytes.size() >= pixels * layout.bytes_per_pixel());
  std::vector<std::uint16_t> dn(pixels);
  if (layout.bytes_per_pixel() == 1) {
    for (std::size_t i = 0; i < pixels; ++i) dn[i] = bytes[i];
  } else {
    for (std::size_t i = 0; i < pixels; ++i) dn[i] = static_cast<std::uint16_t>(bytes[2 * i] | bytes[2 * i + 1] << 8);
  }
  return dn;
}

}  // namespace lumifield
