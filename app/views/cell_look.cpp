#include "app/views/cell_look.h"

#include <QCoreApplication>
#include <algorithm>

namespace lumifield {

namespace {
constexpr double decades_shown = 1e4;
constexpr std::size_t bins = 128;
}  // namespace

ValueScale scale_of(const CellLook& look, double own_largest, double common_largest) {
  const double largest = look.range == CellLook::Range::common ? common_largest : own_largest;
  const bool logarithmic = look.range == CellLook::Range::logarithmic;
  const double to = largest > 0 ? largest : 1;
  return {logarithmic ? to / decades_shown : 0, to, logarithmic, look.grey};
}

Histogram histogram_of(const CellImage& image, int channel, const QString& unit) {
  const float* from = image.channel(channel);
  const auto [low, high] = std::minmax_element(from, from + image.plane());
  const double least = std::min(0.0, double(*low)), largest = *high > least ? double(*high) : least + 1;
  Histogram histogram{
      std::vector<std::uint64_t>(bins, 0),          least, largest,
      QCoreApplication::translate("CellView", "C"), unit,  QCoreApplication::translate("CellView", "pixels")};
  const double per_value = bins / (largest - least);
  for (std::size_t k = 0; k < image.plane(); ++k)
    ++histogram.counts[std::min(bins - 1, static_cast<std::size_t>((double(from[k]) - least) * per_value))];
  return histogram;
}

}  // namespace lumifield
