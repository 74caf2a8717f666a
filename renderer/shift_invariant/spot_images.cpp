#include "renderer/shift_invariant/spot_images.h"

#include <algorithm>
#include <cmath>

namespace lumifield {

double spot_width(const Basis& basis) {
  const double half = basis.half_support();
  return 2 * std::sqrt(basis.moment(2, -half, half));
}

double spot_level(const Basis& basis, const Vec2& rate, int coarsest) {
  const double width = spot_width(basis) * rate.cwiseAbs().maxCoeff();
  return width > 1 ? std::min(std::log2(width), static_cast<double>(coarsest)) : 0;
}

SpotImage::SpotImage(const CellImage& image) : image_(&image) {
  for (int c = 0; c < image.channels; ++c)
    coarse_.push_back(coarse_levels(image.channel(c), image.width_px, image.height_px));
}

double SpotImage::texel(int channel, int i, int j, int level) const {
  if (i < 0 || j < 0) return 0;
  if (level == 0) return i < image_->width_px && j < image_->height_px ? image_->at(channel, i, j) : 0;
  const ImageLevel& of = coarse_[static_cast<std::size_t>(channel)][static_cast<std::size_t>(level - 1)];
  if (i >= of.width_px || j >= of.height_px) return 0;
  return of.value[static_cast<std::size_t>(j) * static_cast<std::size_t>(of.width_px) + static_cast<std::size_t>(i)];
}

double SpotImage::bilinear(int channel, const Vec2& at_px, int level) const {
  const Vec2 at = at_px * std::ldexp(1.0, -level) - Vec2(0.5, 0.5);
  // Far beyond the image is beyond any level.
  const Vec2 low = at.array().floor().cwiseMax(-2.0).cwiseMin(1e9);
  const Vec2 part = (at - low).cwiseMax(0.0).cwiseMin(1.0);
  const int i = static_cast<int>(low.x()), j = static_cast<int>(low.y());
  const auto row = [&](int y) {
    return (1 - part.x()) * texel(channel, i, y, level) + part.x() * texel(channel, i + 1, y, level);
  };
  return (1 - part.y()) * row(j) + part.y() * row(j + 1);
}

double SpotImage::look_up(int channel, const Vec2& at_px, double level) const {
  const int below = static_cast<int>(level);
  const double part = level - below, fine = bilinear(channel, at_px, below);
  return part > 0 ? (1 - part) * fine + part * bilinear(channel, at_px, below + 1) : fine;
}

SpotLayout::SpotLayout(int image_width_px, int image_height_px, bool with_levels)
    : levels{{0, 0, image_width_px, image_height_px}}, width_px(image_width_px), height_px(image_height_px) {
  if (!with_levels) return;
  levels[0].x_px = levels[0].y_px = 1;
  width_px += 2;
  height_px += 2;
  const int column = width_px, coarsest = coarsest_level(image_width_px, image_height_px);
  int y = 1;
  for (int level = 1; level <= coarsest; ++level) {
    const Level& finer = levels.back();
    const Level next{column + 1, y, (finer.width_px + 1) / 2, (finer.height_px + 1) / 2};
    levels.push_back(next);
    y += next.height_px + 2;
    width_px = std::max(width_px, next.x_px + next.width_px + 1);
    height_px = std::max(height_px, next.y_px + next.height_px + 1);
  }
}

}  // namespace lumifield
