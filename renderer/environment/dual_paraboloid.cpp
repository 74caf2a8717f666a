#include "renderer/environment/dual_paraboloid.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>

#include "renderer/bands.h"

namespace lumifield {

namespace {

constexpr double b = DualParaboloid::b;

/// x/(1 + |z|) or y/(1 + |z|) at a texture coordinate.
double spread_out(double s) { return 2 * b * (s - 0.5); }

/// Solid angle over ds dt there.
double density(double x, double y) {
  const double above = 2 / (1 + x * x + y * y);  // 1 + |z|
  return 4 * b * b * above * above;
}

}  // namespace

DualParaboloid::DualParaboloid(const LatLong& environment) : DualParaboloid(*make(environment, {})) {}

std::optional<DualParaboloid> DualParaboloid::make(const LatLong& environment, const std::stop_token& stop) {
  // In the middle, where texels are widest, one spans 4b/side; a pixel spans 2π/width.
  const double least = 4 * b * environment.width_px() / (2 * std::numbers::pi);
  DualParaboloid map;
  map.side_ = std::min(static_cast<int>(std::bit_ceil(static_cast<unsigned>(std::ceil(least)))), largest_side);
  const auto side = static_cast<std::size_t>(map.side_), quarter = side / 2;
  for (auto& levels : map.halves_) levels.push_back({map.side_, std::vector<Eigen::Array4f>(side * side)});

  // Level 0: the means of points as close as the pixels.
  const int points = std::max(3, static_cast<int>(std::ceil(2 * least / map.side_)));
  in_bands(quarter * quarter, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end && !stop.stop_requested(); ++k)
      map.fill(environment, points, quarter + k / quarter, quarter + k % quarter);
  });
  if (stop.stop_requested()) return std::nullopt;
  for (std::vector<float> solid_angle = map.solid_angles(); map.halves_[0].back().side_px > 1;)
    map.add_level(solid_angle);
  return map;
}

/// A texel of x, y > 0 and those that mirror it in x, y and z: what they see is mirrored in the image.
void DualParaboloid::fill(const LatLong& environment, int points, std::size_t row, std::size_t column) {
  const int width = environment.width_px(), height = environment.height_px();
  std::array<std::array<double, 3>, 8> sums{};
  double all = 0;
  for (int k = 0; k < points * points; ++k) {
    const double x = spread_out((static_cast<double>(column) + (k % points + 0.5) / points) / side_);
    const double y = spread_out((static_cast<double>(row) + (k / points + 0.5) / points) / side_);
    const double part = density(x, y);
    const auto [i, j] = environment.pixel_at({2 * x, 2 * y, 1 - x * x - y * y});
    const int behind = width + width / 2 - 1 - i;  // of −y
    const std::array columns{i, width - 1 - i, behind, width - 1 - behind};
    const std::array rows{j, height - 1 - j};
    for (std::size_t mirror = 0; mirror < 8; ++mirror) {
      const auto light = environment.pixel(columns[mirror % 4], rows[mirror / 4]);
      for (std::size_t c = 0; c < 3; ++c) sums[mirror][c] += part * light[c];
    }
    all += part;
  }
  const auto last = static_cast<std::size_t>(side_) - 1;
  for (std::size_t mirror = 0; mirror < 8; ++mirror) {
    const std::size_t at = (mirror & 2 ? last - row : row) * (last + 1) + (mirror & 1 ? last - column : column);
    const auto& sum = sums[mirror];
    halves_[mirror / 4].front().texels[at] = {static_cast<float>(sum[0] / all), static_cast<float>(sum[1] / all),
                                              static_cast<float>(sum[2] / all), 0.0F};
  }
}

/// Of the texels of level 0, over that of one of dω = ds dt.
std::vector<float> DualParaboloid::solid_angles() const {
  std::vector<float> all;
  all.reserve(halves_[0].front().texels.size());
  for (int row = 0; row < side_; ++row)
    for (int column = 0; column < side_; ++column)
      all.push_back(static_cast<float>(density(spread_out((column + 0.5) / side_), spread_out((row + 0.5) / side_))));
  return all;
}

/// Means of four, by solid angle, which is added up too.
void DualParaboloid::add_level(std::vector<float>& solid_angle) {
  const auto wide = static_cast<std::size_t>(halves_[0].back().side_px), side = wide / 2;
  std::array<std::vector<Eigen::Array4f>, 2> texels;
  for (auto& each : texels) each.reserve(side * side);
  std::vector<float> all;
  all.reserve(side * side);
  for (std::size_t row = 0; row < side; ++row)
    for (std::size_t column = 0; column < side; ++column) {
      const std::size_t first = 2 * row * wide + 2 * column;
      const std::array four{first, first + 1, first + wide, first + wide + 1};
      float part = 0;
      for (const std::size_t k : four) part += solid_angle[k];
      for (std::size_t half = 0; half < 2; ++half) {
        const auto& fine = halves_[half].back().texels;
        Eigen::Array4f sum = Eigen::Array4f::Zero();
        for (const std::size_t k : four) sum += solid_angle[k] * fine[k];
        texels[half].emplace_back(sum / part);
      }
      all.push_back(part);
    }
  solid_angle = std::move(all);
  for (std::size_t half = 0; half < 2; ++half)
    halves_[half].push_back({static_cast<int>(side), std::move(texels[half])});
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
