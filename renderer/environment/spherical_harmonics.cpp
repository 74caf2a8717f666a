#include "renderer/environment/spherical_harmonics.h"

#include <numbers>

namespace lumifield {

std::array<double, IrradianceHarmonics::count> IrradianceHarmonics::basis(const Vec3& d) {
  const double x = d.x(), y = d.y(), z = d.z();
  return {0.28209479177387814,
          0.4886025119029199 * y,
          0.4886025119029199 * z,
          0.4886025119029199 * x,
          1.0925484305920792 * x * y,
          1.0925484305920792 * y * z,
          0.31539156525252005 * (3 * z * z - 1),
          1.0925484305920792 * x * z,
          0.5462742152960396 * (x * x - y * y)};
}

IrradianceHarmonics::IrradianceHarmonics(const LatLong& environment) {
  using std::numbers::pi;
  for (int j = 0; j < environment.height_px(); ++j) {
    const double solid_angle = environment.solid_angle(j);
    for (int i = 0; i < environment.width_px(); ++i) {
      const auto light = environment.pixel(i, j);
      const auto y = basis(environment.direction(i + 0.5, j + 0.5));
      for (std::size_t k = 0; k < count; ++k)
        for (std::size_t c = 0; c < 3; ++c) reflected_[k][c] += solid_angle * light[c] * y[k];
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
