#include "renderer/methods/image_levels.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace lumifield {

namespace {

/// Of 2×2 pixels each, those beyond the image counted as 0: `join` of all, from `begin` on.
template <class T, class Join>
ImageLevel halved(const T* image, int width_px, int height_px, double begin, const Join& join) {
  ImageLevel level{(width_px + 1) / 2, (height_px + 1) / 2, {}};
  const auto width = static_cast<std::size_t>(width_px), half_width = static_cast<std::size_t>(level.width_px);
  level.value.assign(half_width * static_cast<std::size_t>(level.height_px), begin);
  for (std::size_t j = 0; j < static_cast<std::size_t>(height_px); ++j) {
    const T* row = image + j * width;
    double* out = level.value.data() + j / 2 * half_width;
    for (std::size_t i = 0; i + 1 < width; i += 2)
      out[i / 2] = join(out[i / 2], static_cast<double>(row[i]), static_cast<double>(row[i + 1]));
    if (width % 2 == 1) out[width / 2] = join(out[width / 2], static_cast<double>(row[width - 1]), 0.0);
  }
  if (height_px % 2 == 1)
    for (auto last = level.value.end() - level.width_px; last != level.value.end(); ++last)
      *last = join(*last, 0.0, 0.0);
  return level;
}

template <class Join>
std::vector<ImageLevel> all_halved(const float* channel, int width_px, int height_px, double begin, const Join& join) {
  std::vector<ImageLevel> levels;
  const int coarsest = coarsest_level(width_px, height_px);
  for (int level = 1; level <= coarsest; ++level)
    levels.push_back(
        level == 1 ? halved(channel, width_px, height_px, begin, join)
                   : halved(levels.back().value.data(), levels.back().width_px, levels.back().height_px, begin, join));
  return levels;
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
  return all_halved(channel, width_px, height_px, 0, [](double sum, double a, double b) { return sum + (a + b) / 4; });
}

std::vector<ImageLevel> coarse_deviations(const float* channel, int width_px, int height_px,
                                          const std::vector<ImageLevel>& means) {
  std::vector<ImageLevel> deviations = means;
  const std::vector<ImageLevel> least =
      all_halved(channel, width_px, height_px, HUGE_VAL, [](double m, double a, double b) {
        return std::min({m, a, b});
      });
  const std::vector<ImageLevel> greatest =
      all_halved(channel, width_px, height_px, -HUGE_VAL, [](double m, double a, double b) {
        return std::max({m, a, b});
      });
  for (std::size_t level = 0; level < deviations.size(); ++level)
    for (std::size_t k = 0; k < deviations[level].value.size(); ++k) {
      double& mean = deviations[level].value[k];
      mean = std::max(greatest[level].value[k] - mean, mean - least[level].value[k]);
    }
  return deviations;
}

int level_of_detail(double pixels_per_support, double span_px, int coarsest) {
  int level = 0;
  if (pixels_per_support > 0)
    for (; span_px > pixels_per_support && level < coarsest; ++level) span_px /= 2;
  return level;
}

}  // namespace lumifield
