#include "renderer/shift_invariant/constant_distance_error.h"

#include <algorithm>
#include <cmath>

#include "luminaire/basis.h"

namespace lumifield {

double constant_distance_error(double half_support, double theta0_rad, double azimuth_rad) {
  const double h = std::abs(half_support), off = std::tan(theta0_rad);
  const double x = std::abs(off * std::cos(azimuth_rad)), y = std::abs(off * std::sin(azimuth_rad));
  // cos⁴ = 1/(1 + q²)², q the distance of the foot of δ = 1: least at the nearest point of the square, most at a
  // corner.
  const double near_x = std::max(x - h, 0.0), near_y = std::max(y - h, 0.0);
  const auto term = [](double qx, double qy) { return std::pow(1 + qx * qx + qy * qy, -2); };
  return (term(near_x, near_y) - term(x + h, y + h)) / term(x, y);
}

double largest_constant_distance_error(const LuminaireGeometry& geometry, CellIndex cell) {
  constexpr int places = 33;
  const Sampling& sampling = geometry.sampling;
  const double half = Basis(sampling.basis).half_support() * sampling.spacing_mm.maxCoeff();
  const double delta = geometry.planes.separation_mm;
  const Vec2 corner = geometry.measurement.corner_mm(), size = 2 * (geometry.measurement.center_mm - corner);
  const Vec2 u = sampling.cell_center_mm(cell);
  double largest = 0;
  for (int j = 0; j < places; ++j)
    for (int i = 0; i < places; ++i) {
      const Vec2 off = corner + size.cwiseProduct(Vec2(i, j) / (places - 1)) - u;
      largest = std::max(
          largest, constant_distance_error(half / delta, std::atan2(off.norm(), delta), std::atan2(off.y(), off.x())));
    }
  return largest;
}

}  // namespace lumifield
