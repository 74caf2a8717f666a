#include "renderer/methods/gloss.h"

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

namespace lumifield {

std::array<double, 3> glossy_brdf(const GlossLobe& l, const Vec3& normal, const Vec3& i) {
  // As float they are not quite of unit length, which an exponent of 1e5 would show.
  const Vec3 n = normal.normalized(), o = Vec3(l.eye_x, l.eye_y, l.eye_z).normalized();
  const double ni = n.dot(i), no = n.dot(o), shape = l.shape;
  if (!(ni > 0 && no > 0) || l.kind == LOBE_NONE) return {0, 0, 0};
  if (l.kind == LOBE_PHONG) {
    const double f = (shape + 2) / (2 * std::numbers::pi) * std::pow(std::max((2 * no * n - o).dot(i), 0.0), shape);
    return {l.r * f, l.g * f, l.b * f};
  }
  const Vec3 h = (i + o).normalized();
  const double a2 = shape * shape, d = a2 + (1 - a2) * n.cross(h).squaredNorm();
  const double ri = no * std::sqrt(a2 + (1 - a2) * ni * ni), ro = ni * std::sqrt(a2 + (1 - a2) * no * no);
  const double f = a2 / (std::numbers::pi * d * d) / std::max(2 * (ri + ro), 1e-200);
  const double w = std::pow(1 - h.dot(o), 5);
  return {f * (l.r + (1 - l.r) * w), f * (l.g + (1 - l.g) * w), f * (l.b + (1 - l.b) * w)};
}

}  // namespace lumifield
