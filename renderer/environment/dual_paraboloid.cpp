#include "renderer/environment/dual_paraboloid.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>

namespace lumifield {

namespace {

constexpr double b = DualParaboloid::b;
constexpr int largest_side = 2048;

/// At texture coordinates of an image; the corners are well beyond its own half.
Vec3 direction_at(double s, double t, int half) {
  const double x = 2 * b * (s - 0.5), y = 2 * b * (t - 0.5), r2 = x * x + y * y;
  const double z = (1 - r2) / (1 + r2);
  return {x * (1 + z), y * (1 + z), half == 0 ? z : -z};
}

/// Over ds dt there.
double spread_at(double s, double t) {
  const double x = 2 * b * (s - 0.5), y = 2 * b * (t - 0.5), above = 2 / (1 + x * x + y * y);  // 1 + z
  return 4 * b * b * above * above;
}

}  // namespace

DualParaboloid::DualParaboloid(const LatLong& environment) {
  // In the middle, where texels are widest, one spans 4b/side; a pixel spans 2π/width.
  const double least = 4 * b * environment.width_px() / (2 * std::numbers::pi);
  side_ = std::min(static_cast<int>(std::bit_ceil(static_cast<unsigned>(std::ceil(least)))), largest_side);
  for (int half = 0; half < 2; ++half) {
    fill(environment, half);
    std::vector<float> solid_angle;
    const auto side = static_cast<std::size_t>(side_);
    for (std::size_t k = 0; k < side * side; ++k)
      solid_angle.push_back(static_cast<float>(
          spread_at((static_cast<double>(k % side) + 0.5) / side_, (static_cast<double>(k / side) + 0.5) / side_)));
    while (halves_[static_cast<std::size_t>(half)].back().side_px > 1) add_level(half, solid_angle);
  }
}

/// Level 0: the means of points as close as the pixels.
void DualParaboloid::fill(const LatLong& environment, int half) {
  const double least = 4 * b * environment.width_px() / (2 * std::numbers::pi);
  const int points = std::max(3, static_cast<int>(std::ceil(2 * least / side_)));
  Level level{side_, {}};
  level.texels.reserve(static_cast<std::size_t>(side_) * static_cast<std::size_t>(side_));
  for (int row = 0; row < side_; ++row)
    for (int column = 0; column < side_; ++column) {
      std::array<double, 3> sum{};
      double all = 0;
      for (int k = 0; k < points * points; ++k) {
        const double s = (column + (k % points + 0.5) / points) / side_;
        const double t = (row + (k / points + 0.5) / points) / side_;
        const auto light = environment.radiance(direction_at(s, t, half));
        const double part = spread_at(s, t);
        for (std::size_t c = 0; c < 3; ++c) sum[c] += part * light[c];
        all += part;
      }
      level.texels.emplace_back(static_cast<float>(sum[0] / all), static_cast<float>(sum[1] / all),
                                static_cast<float>(sum[2] / all), 0.0F);
    }
  halves_[static_cast<std::size_t>(half)].push_back(std::move(level));
}

/// Means of four, by solid angle, which is added up too.
void DualParaboloid::add_level(int half, std::vector<float>& solid_angle) {
  auto& levels = halves_[static_cast<std::size_t>(half)];
  const Level& fine = levels.back();
  const auto wide = static_cast<std::size_t>(fine.side_px), side = wide / 2;
  Level level{static_cast<int>(side), {}};
  level.texels.reserve(side * side);
  std::vector<float> all;
  all.reserve(side * side);
  for (std::size_t row = 0; row < side; ++row)
    for (std::size_t column = 0; column < side; ++column) {
      Eigen::Array4f sum = Eigen::Array4f::Zero();
      float part = 0;
      for (const std::size_t k : {2 * row * wide + 2 * column, 2 * row * wide + 2 * column + 1,
                                  (2 * row + 1) * wide + 2 * column, (2 * row + 1) * wide + 2 * column + 1}) {
        sum += solid_angle[k] * fine.texels[k];
        part += solid_angle[k];
      }
      level.texels.emplace_back(sum / part);
      all.push_back(part);
    }
  solid_angle = std::move(all);
  levels.push_back(std::move(level));
}

double DualParaboloid::texel_solid_angle(double z) const {
  const double above = 1 + std::abs(z);
  return 4 * b * b * above * above / (static_cast<double>(side_) * side_);
}

double DualParaboloid::level(double solid_angle, double z) const {
  return std::max(0.0, 0.5 * std::log2(solid_angle / texel_solid_angle(z))) + overlap;
}

Eigen::Array4f DualParaboloid::Level::at(float s, float t) const {
  const auto side = static_cast<float>(side_px);
  const float x = std::clamp(s * side - 0.5F, 0.0F, side - 1), y = std::clamp(t * side - 0.5F, 0.0F, side - 1);
  const auto i = static_cast<std::size_t>(x), j = static_cast<std::size_t>(y), wide = static_cast<std::size_t>(side_px);
  const float fx = x - static_cast<float>(i), fy = y - static_cast<float>(j);
  const std::size_t right = i + 1 < wide ? 1 : 0, below = j + 1 < wide ? wide : 0;
  const Eigen::Array4f* texel = &texels[j * wide + i];
  const Eigen::Array4f upper = texel[0] + fx * (texel[right] - texel[0]);
  const Eigen::Array4f lower = texel[below] + fx * (texel[below + right] - texel[below]);
  return upper + fy * (lower - upper);
}

Eigen::Array4f DualParaboloid::radiance(const Vec3& direction, double level) const {
  const auto& half = halves_[direction.z() < 0 ? 1 : 0];
  const double scale = 1 / (2 * b * (1 + std::abs(direction.z())));
  const auto s = static_cast<float>(0.5 + direction.x() * scale), t = static_cast<float>(0.5 + direction.y() * scale);
  const double last = levels() - 1, at = std::clamp(level, 0.0, last);
  const auto below = static_cast<std::size_t>(at);
  const auto share = static_cast<float>(at - static_cast<double>(below));
  const Eigen::Array4f light = half[below].at(s, t);
  return share > 0 ? Eigen::Array4f(light + share * (half[below + 1].at(s, t) - light)) : light;
}

}  // namespace lumifield
