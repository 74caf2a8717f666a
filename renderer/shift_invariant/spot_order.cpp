#include "renderer/shift_invariant/spot_order.h"

#include <algorithm>
#include <cmath>

#include "renderer/bands.h"
#include "renderer/shift_invariant/spot_images.h"

namespace lumifield {

namespace {

/// Bounds of what the cells light, in float with room for what floats round.
class LitRegion {
 public:
  explicit LitRegion(const LuminaireGeometry& g)
      : separation_(g.planes.separation_mm), spacing_(g.sampling.spacing_mm), image_low_(g.measurement.corner_mm()) {
    const Sampling& s = g.sampling;
    const Basis basis(s.basis);
    low_ = s.cell_center_mm({0, 0});
    high_ = s.cell_center_mm({s.rows - 1, s.columns - 1});
    image_high_ = 2 * g.measurement.center_mm - image_low_;
    // A support, or the texels about a look-up, of which the coarser are at most twice as wide as it blurs.
    reach_ = std::max(basis.half_support(), 2 * spot_width(basis));
    slack_ = 3 * g.measurement.pixel_mm + 1e-5 * (image_high_ - image_low_);
  }
  bool may_light(const float* p, const float* n) const {
    const double z = p[2], n_x = n[0], n_y = n[1], n_z = n[2];
    if (!(z > 0) || (n_x == 0 && n_y == 0 && n_z == 0)) return false;
    const double x = p[0], y = p[1];
    const double toward_x = n_x * ((n_x > 0 ? high_.x() : low_.x()) - x),
                 toward_y = n_y * ((n_y > 0 ? high_.y() : low_.y()) - y);
    if (!(toward_x + toward_y - n_z * z > -1e-6 * (std::abs(toward_x) + std::abs(toward_y) + std::abs(n_z * z))))
      return false;
    const double t = separation_ / z, r = 1 - t;
    return sees(0, x, t, r) && sees(1, y, t, r);
  }

 private:
  bool sees(Eigen::Index axis, double p, double t, double r) const {
    const double a = p * t + r * low_[axis], b = p * t + r * high_[axis];
    const double wide = std::abs(r) * reach_ * spacing_[axis] + slack_[axis] + 1e-5 * std::abs(p * t);
    return std::max(a, b) + wide >= image_low_[axis] && std::min(a, b) - wide <= image_high_[axis];
  }

  double separation_, reach_;
  Vec2 spacing_, image_low_, image_high_, low_, high_, slack_;
};

}  // namespace

SpotOrder::SpotOrder(const LuminaireGeometry& geometry, std::span<const float> p, std::span<const float> n,
                     int picture_columns, int most_columns) {
  const std::size_t count = p.size() / 4;
  std::vector<char> lit(count);
  const LitRegion region(geometry);
  in_bands(count, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) lit[k] = region.may_light(p.data() + 4 * k, n.data() + 4 * k);
  });

  std::vector<std::uint32_t> upper, lower;
  const bool picture = picture_columns > 0 && count % static_cast<std::size_t>(picture_columns) == 0;
  const std::size_t width = picture ? static_cast<std::size_t>(picture_columns) : 1;
  for (std::size_t first = 0; first < count; first += 2 * width)
    for (std::size_t k = first; k < std::min(first + width, count); ++k) {
      const bool has_below = k + width < count && lit[k + width];
      if (!lit[k] && !has_below) continue;
      upper.push_back(static_cast<std::uint32_t>(k));
      lower.push_back(has_below ? static_cast<std::uint32_t>(k + width) : none);
    }
  const std::size_t row =
      std::min<std::size_t>(upper.size() > (std::size_t(1) << 18) ? 4096 : 512, static_cast<std::size_t>(most_columns));
  columns = static_cast<int>(std::clamp<std::size_t>(upper.size(), 1, row));
  const auto wide = static_cast<std::size_t>(columns);
  const std::size_t strips = (upper.size() + wide - 1) / wide;
  rows = static_cast<int>(2 * strips);
  receiver.assign(2 * strips * wide, none);
  for (std::size_t k = 0; k < upper.size(); ++k) {
    const std::size_t texel = k / wide * 2 * wide + k % wide;
    receiver[texel] = upper[k];
    receiver[texel + wide] = lower[k];
  }
}

}  // namespace lumifield
