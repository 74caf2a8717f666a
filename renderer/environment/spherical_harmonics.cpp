#include "renderer/environment/spherical_harmonics.h"

#include <cmath>
#include <numbers>

namespace lumifield {

namespace {

using std::numbers::pi;
constexpr double y0 = 0.28209479177387814, y1 = 0.4886025119029199, y2 = 1.0925484305920792, y20 = 0.31539156525252005,
                 y22 = 0.5462742152960396;

/// Antiderivatives over the turn φ from +y towards +x: of 1, sin φ, cos φ, sin φ cos φ, sin²φ − cos²φ.
std::array<double, 5> over_turn(double phi) {
  const double s = std::sin(phi), c = std::cos(phi);
  return {phi, -c, s, s * s / 2, -s * c};
}

/// Over the angle θ from +z, times sin θ: of 1, sin θ, cos θ, sin²θ, sin θ cos θ, 3 cos²θ − 1.
std::array<double, 6> over_height(double theta) {
  const double s = std::sin(theta), c = std::cos(theta);
  return {-c, (theta - s * c) / 2, s * s / 2, c * c * c / 3 - c, s * s * s / 3, c - c * c * c};
}

template <std::size_t n>
std::array<double, n> minus(std::array<double, n> a, const std::array<double, n>& b) {
  for (std::size_t k = 0; k < n; ++k) a[k] -= b[k];
  return a;
}

/// Σ over a row's pixels of L and the five integrals over each's turn.
using RowMoments = std::array<std::array<double, 3>, 5>;
RowMoments moments_of(const LatLong& environment, int row, const std::vector<std::array<double, 5>>& turns) {
  RowMoments moments{};
  for (int i = 0; i < environment.width_px(); ++i) {
    const auto light = environment.pixel(i, row);
    for (std::size_t k = 0; k < 5; ++k)
      for (std::size_t c = 0; c < 3; ++c) moments[k][c] += turns[static_cast<std::size_t>(i)][k] * light[c];
  }
  return moments;
}

}  // namespace

std::array<double, IrradianceHarmonics::count> IrradianceHarmonics::basis(const Vec3& d) {
  const double x = d.x(), y = d.y(), z = d.z();
  return {y0, y1 * y, y1 * z, y1 * x, y2 * x * y, y2 * y * z, y20 * (3 * z * z - 1), y2 * x * z, y22 * (x * x - y * y)};
}

/// Y_lm of x = sin θ sin φ, y = sin θ cos φ, z = cos θ is a product of one of θ and one of φ.
IrradianceHarmonics::IrradianceHarmonics(const LatLong& environment) {
  const int width = environment.width_px(), height = environment.height_px();
  std::vector<std::array<double, 5>> turns;
  for (int i = 0; i < width; ++i)
    turns.push_back(minus(over_turn(2 * pi * ((i + 1.0) / width - 0.5)), over_turn(2 * pi * (1.0 * i / width - 0.5))));
  for (int j = 0; j < height; ++j) {
    const auto [one, sine, cosine, sine_2, sine_cosine, degree_20] =
        minus(over_height(pi * (j + 1) / height), over_height(pi * j / height));
    const RowMoments row = moments_of(environment, j, turns);
    for (std::size_t c = 0; c < 3; ++c) {
      const std::array<double, count> part{
          y0 * one * row[0][c],        y1 * sine * row[2][c],        y1 * cosine * row[0][c],
          y1 * sine * row[1][c],       y2 * sine_2 * row[3][c],      y2 * sine_cosine * row[2][c],
          y20 * degree_20 * row[0][c], y2 * sine_cosine * row[1][c], y22 * sine_2 * row[4][c]};
      for (std::size_t k = 0; k < count; ++k) reflected_[k][c] += part[k];
    }
  }
  for (std::size_t k = 0; k < count; ++k)
    for (double& each : reflected_[k]) each *= k == 0 ? pi : k < 4 ? 2 * pi / 3 : pi / 4;
}

std::array<double, 3> IrradianceHarmonics::irradiance(const Vec3& n) const {
  const auto y = basis(n);
  std::array<double, 3> e{};
  for (std::size_t k = 0; k < count; ++k)
    for (std::size_t c = 0; c < 3; ++c) e[c] += reflected_[k][c] * y[k];
  return e;
}

}  // namespace lumifield
