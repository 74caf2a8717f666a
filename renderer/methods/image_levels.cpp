#include "renderer/methods/image_levels.h"

#include <cstddef>

namespace lumifield {

namespace {

/// Means of 2×2 pixels, those beyond the image counted as 0.
template <class T>
ImageLevel halved(const T* image, int width_px, int height_px) {
  ImageLevel level{(width_px + 1) / 2, (height_px + 1) / 2, {}};
  const auto width = static_cast<std::size_t>(width_px), half_width = static_cast<std::size_t>(level.width_px);
  level.mean.assign(half_width * static_cast<std::size_t>(level.height_px), 0.0);
  for (std::size_t j = 0; j < static_cast<std::size_t>(height_px); ++j) {
    const T* row = image + j * width;
    double* out = level.mean.data() + j / 2 * half_width;
    for (std::size_t i = 0; i + 1 < width; i += 2) out[i / 2] += (static_cast<double>(row[i]) + row[i + 1]) / 4;
    if (width % 2 == 1) out[width / 2] += static_cast<double>(row[width - 1]) / 4;
  }
  return level;
}

}  // namespace

int coarsest_level(int width_px, int height_px) {
  int level = 0;
  for (; width_px > 1 || height_px > 1; ++level) {
    width_px -= width_px / 2;
    height_px -= height_px / 2;
  }
  return level;
}

std::vector<ImageLevel> coarse_levels(const float* channel, int width_px, int height_px) {
  std::vector<ImageLevel> levels;
  const int coarsest = coarsest_level(width_px, height_px);
  for (int level = 1; level <= coarsest; ++level)
    levels.push_back(level == 1 ? halved(channel, width_px, height_px)
                                : halved(levels.back().mean.data(), levels.back().width_px, levels.back().height_px));
  return levels;
}

int level_of_detail(double pixels_per_support, double span_px, int coarsest) {
  int level = 0;
  if (pixels_per_support > 0)
    for (; span_px > pixels_per_support && level < coarsest; ++level) span_px /= 2;
  return level;
}

}  // namespace lumifield
