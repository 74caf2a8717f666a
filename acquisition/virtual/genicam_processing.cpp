#include "acquisition/virtual/genicam_processing.h"

#include <algorithm>
#include <cmath>

namespace lumifield::virtual_bench {

void GenicamProcessing::apply(std::span<std::uint16_t> dn, int width_px, int bits, std::uint64_t frame) const {
  if (mirrored_x != mirrored_y)
    for (std::size_t row = 0; row < dn.size(); row += std::size_t(width_px))
      std::ranges::reverse(dn.subspan(row, std::size_t(width_px)));
  if (mirrored_y) std::ranges::reverse(dn);  // with the rows' own turn: bottom to top alone
  const double full = (1 << bits) - 1, gain = std::pow(10, gain_db / 20);
  for (std::size_t i = 0; i < dn.size(); ++i) {
    const std::size_t row = i / std::size_t(width_px), column = i % std::size_t(width_px);
    const bool is_red = row % 2 == 0 && column % 2 == 0, is_blue = row % 2 == 1 && column % 2 == 1;
    double value = dn[i] * gain * (is_red ? red : is_blue ? blue : 1);
    if (black_level) value += double(1 + frame % 7);
    if (white_balance && is_red) value *= 1.25;
    if (gamma != 1) value = full * std::pow(value / full, gamma);
    if (table) value /= 2;
    dn[i] = std::uint16_t(std::min(value, full));
  }
}

void bin(std::span<const std::uint16_t> dn, int columns, int rows, int width_px, std::span<std::uint16_t> out) {
  const std::size_t width = std::size_t(width_px), full_width = width * std::size_t(columns);
  for (std::size_t i = 0; i < out.size(); ++i) {
    const std::size_t y = i / width * std::size_t(rows), x = i % width * std::size_t(columns);
    unsigned sum = 0;
    for (std::size_t dy = 0; dy < std::size_t(rows); ++dy)
      for (std::size_t dx = 0; dx < std::size_t(columns); ++dx) sum += dn[(y + dy) * full_width + x + dx];
    out[i] = std::uint16_t(sum / unsigned(columns * rows));
  }
}

}  // namespace lumifield::virtual_bench
