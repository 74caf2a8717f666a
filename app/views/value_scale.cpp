#include "app/views/value_scale.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "renderer/false_colour.h"

namespace lumifield {

double ValueScale::share(double value) const {
  if (std::isnan(value) || !(to > from)) return value >= to ? 1 : value < to ? 0 : NAN;
  if (!logarithmic) return std::clamp((value - from) / (to - from), 0.0, 1.0);
  return value <= from ? 0 : std::min(1.0, std::log(value / from) / std::log(to / from));
}

QRgb share_colour(double share, bool grey) {
  if (grey && !std::isnan(share)) {
    const int level = static_cast<int>(std::lround(255 * std::clamp(share, 0.0, 1.0)));
    return qRgb(level, level, level);
  }
  const auto [red, green, blue] = false_colour(share);
  return qRgb(red, green, blue);
}

QImage colour_image(const float* values, int width, int height, const ValueScale& scale) {
  std::array<QRgb, 256> colours{};
  for (std::size_t k = 0; k < colours.size(); ++k) colours[k] = share_colour(static_cast<double>(k) / 255, scale.grey);
  QImage image(width, height, QImage::Format_RGB32);
  for (int j = 0; j < height; ++j) {
    const float* row = values + static_cast<std::ptrdiff_t>(j) * width;
    auto* to = reinterpret_cast<QRgb*>(image.scanLine(height - 1 - j));
    for (int i = 0; i < width; ++i) {
      const double share = scale.share(row[i]);
      to[i] =
          std::isnan(share) ? share_colour(share, scale.grey) : colours[static_cast<std::size_t>(share * 255 + 0.5)];
    }
  }
  return image;
}

}  // namespace lumifield
