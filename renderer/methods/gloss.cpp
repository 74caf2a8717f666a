#include "renderer/methods/gloss.h"

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

namespace lumifield {

std::array<double, 3> glossy_brdf(const GlossLobe& l, const Vec3& n, const Vec3& i) {
  const Vec3 o = Vec3(l.eye_x, l.eye_y, l.eye_z).normalized();  // as float it is not quite of unit length
  const double ni = n.dot(i), no = n.dot(o), shape = l.shape;
  if (!(ni > 0 && no > 0) || l.kind == LOBE_NONE) return {0, 0, 0};
  if (l.kind == LOBE_PHONG) {
    const double f = (shape + 2) / (2 * std::numbers::pi) * std::pow(std::max((2 * no * n - o).dot(i), 0.0), shape);
    return {l.r * f, l.g * f, l.b * f};
  }
  const Vec3 h = (i + o).normalized();
  const double nh = n.dot(h), a2 = shape * shape, d = n.cross(h).squaredNorm() + a2 * nh * nh;
  const double ri = no * std::sqrt(a2 + (1 - a2) * ni * ni), ro = ni * std::sqrt(a2 + (1 - a2) * no * no);
  const double f = a2 / (std::numbers::pi * d * d) / (2 * (ri + ro)), w = std::pow(1 - h.dot(o), 5);
  return {f * (l.r + (1 - l.r) * w), f * (l.g + (1 - l.g) * w), f * (l.b + (1 - l.b) * w)};
}

}  // namespace lumifield
