#include "acquisition/virtual/gige_processing.h"

#include <algorithm>
#include <cmath>

namespace lumifield::virtual_bench {

void GigeProcessing::apply(std::span<std::uint16_t> dn, int width_px, int bits, std::uint64_t frame) const {
  const double full = (1 << bits) - 1;
  for (std::size_t i = 0; i < dn.size(); ++i) {
    const std::size_t row = i / std::size_t(width_px), column = i % std::size_t(width_px);
    double value = dn[i];
    if (black_level) value += double(1 + frame % 7);
    if (white_balance && row % 2 == 0 && column % 2 == 0) value *= 1.25;
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
