#include "renderer/shift_invariant/spot_images.h"

#include <algorithm>
#include <cmath>

namespace lumifield {

int coarsest_spot_level(int width_px, int height_px) {
  const auto pads_little = [](int size, int level) { return 8L * (padded_spot_size(size, level) - size) <= size; };
  int level = 0;
  while (level < 12 && pads_little(width_px, level + 1) && pads_little(height_px, level + 1)) ++level;
  return level;
}

int padded_spot_size(int size_px, int coarsest) {
  const int unit = 1 << coarsest;
  return (size_px + unit - 1) / unit * unit;
}

double spot_width(const Basis& basis) {
  const double half = basis.half_support();
  return 2 * std::sqrt(basis.moment(2, -half, half));
}

double spot_level(const Basis& basis, const Vec2& rate, int coarsest) {
  const double width = spot_width(basis) * rate.cwiseAbs().maxCoeff();
  return width > 1 ? std::min(std::log2(width), static_cast<double>(coarsest)) : 0;
}

SpotImage::SpotImage(const CellImage& image) : image_(&image) {
  const int coarsest = coarsest_spot_level(image.width_px, image.height_px);
  for (int c = 0; c < image.channels; ++c) {
    std::vector<ImageLevel> levels = coarse_levels(image.channel(c), image.width_px, image.height_px);
    levels.resize(std::min(levels.size(), static_cast<std::size_t>(coarsest)));
    coarse_.push_back(std::move(levels));
  }
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

}  // namespace lumifield
