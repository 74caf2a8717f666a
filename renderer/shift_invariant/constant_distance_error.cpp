#include "renderer/shift_invariant/constant_distance_error.h"

#include <algorithm>
#include <cmath>

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

}  // namespace lumifield
