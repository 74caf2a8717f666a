#include "renderer/methods/lobe_sampling.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "renderer/methods/gloss.h"

namespace lumifield {

namespace {

constexpr double pi = std::numbers::pi;
/// So many that few stretches of receivers overlap.
constexpr int least_table = 1 << 12, table_stretches = 4;
/// Half a step of 24 bits: the middle of what a number with so many stands for.
constexpr double half_step = 0x1p-25;

double share_of_turn(double sine, double cosine) {
  const double turn = std::atan2(sine, cosine) / (2 * pi);
  return turn < 0 ? turn + 1 : turn;
}

LobePoint lobe_point(double x, double y) { return {x, std::log(x), std::cos(2 * pi * y), std::sin(2 * pi * y)}; }

}  // namespace

void frame_about(const Vec3& axis, Vec3& across, Vec3& along) {
  const double sign = std::copysign(1.0, axis.z()), a = -1 / (sign + axis.z()), b = axis.x() * axis.y() * a;
  across = {1 + sign * axis.x() * axis.x() * a, sign * b, -sign * axis.x()};
  along = {b, sign + axis.y() * axis.y() * a, -axis.y()};
}

LobeDistribution::LobeDistribution(const GlossLobe& lobe, const Vec3& n)
    : lobe_(lobe), n_(n), normal_(n.normalized()), eye_(normal_), axis_(normal_), no_(1), spread_(1) {
  if (lobe.kind != LOBE_NONE) {
    eye_ = Vec3(lobe.eye_x, lobe.eye_y, lobe.eye_z).normalized();
    no_ = normal_.dot(eye_);
    axis_ = 2 * no_ * normal_ - eye_;
    const double a2 = static_cast<double>(lobe.shape) * lobe.shape;
    spread_ = std::sqrt(a2 + (1 - a2) * no_ * no_);
  }
  frame_about(lobe.kind == LOBE_GGX ? normal_ : axis_, across_, along_);
  if (lobe.kind != LOBE_GGX) return;
  const double alpha = lobe.shape;
  squeezed_ = Vec3(alpha * across_.dot(eye_), alpha * along_.dot(eye_), no_).normalized();
  const double sine = std::hypot(squeezed_.x(), squeezed_.y());
  t1_ = sine > 0 ? Vec3(-squeezed_.y() / sine, squeezed_.x() / sine, 0) : Vec3(1, 0, 0);
  t2_ = squeezed_.cross(t1_);
}

double LobeDistribution::width() const {
  const double shape = lobe_.shape;
  if (lobe_.kind == LOBE_PHONG) return std::min(1.0, 1 / std::sqrt(shape));
  return lobe_.kind == LOBE_GGX ? std::min(1.0, 2 * shape) : 1;
}

double LobeDistribution::angle_from_axis(const Vec3& direction) const {
  return std::atan2(axis_.cross(direction).norm(), axis_.dot(direction));
}

/// Points of the disc that the sphere's upper half shows to the eye.
Vec3 LobeDistribution::half_vector(const LobePoint& xi) const {
  const double alpha = lobe_.shape, r = std::sqrt(xi.x), a = r * xi.cos_phi, low = 0.5 * (1 + squeezed_.z());
  const double b = (1 - low) * std::sqrt(std::max(1 - a * a, 0.0)) + low * r * xi.sin_phi;
  const Vec3 h = a * t1_ + b * t2_ + std::sqrt(std::max(1 - a * a - b * b, 0.0)) * squeezed_;
  return Vec3(alpha * h.x(), alpha * h.y(), std::max(h.z(), 0.0)).normalized();
}

LobeDraw LobeDistribution::sample(const LobePoint& xi) const {
  const auto about_axis = [&](double sine, double cosine) -> Vec3 {
    return sine * xi.cos_phi * across_ + sine * xi.sin_phi * along_ + cosine * axis_;
  };
  LobeDraw draw;
  if (lobe_.kind == LOBE_NONE) {
    const double cosine = std::sqrt(std::max(1 - xi.x, 0.0));
    draw.direction = about_axis(std::sqrt(xi.x), cosine);
    draw.pdf = cosine / pi;
  } else if (lobe_.kind == LOBE_PHONG) {
    const double each = xi.log_x / (static_cast<double>(lobe_.shape) + 1);
    draw.direction = about_axis(std::sqrt(-std::expm1(2 * each)), std::exp(each));
    draw.pdf = (static_cast<double>(lobe_.shape) + 1) / (2 * pi) * std::exp(lobe_.shape * each);
  } else {
    const Vec3 h = half_vector(xi);
    const double a2 = static_cast<double>(lobe_.shape) * lobe_.shape;
    const double d = h.x() * h.x() + h.y() * h.y() + a2 * h.z() * h.z();
    const Vec3 in_frame = h.x() * across_ + h.y() * along_ + h.z() * normal_;
    draw.direction = 2 * in_frame.dot(eye_) * in_frame - eye_;
    draw.pdf = a2 / (pi * d * d) / (2 * (no_ + spread_));
  }
  draw.weight = weight(draw.direction);
  return draw;
}

/// D and G₁ leave f/pdf: Phong's is a constant, GGX's Smith's heights.
std::array<double, 3> LobeDistribution::weight(const Vec3& i) const {
  const double facing = n_.dot(i);
  if (!(facing > 0 && shines())) return {};
  if (lobe_.kind == LOBE_NONE) return {pi * n_.norm(), pi * n_.norm(), pi * n_.norm()};
  const double shape = lobe_.shape;
  if (lobe_.kind == LOBE_PHONG) {
    const double ratio = (shape + 2) / (shape + 1) * facing;
    return {lobe_.r * ratio, lobe_.g * ratio, lobe_.b * ratio};
  }
  const double ni = normal_.dot(i), a2 = shape * shape, si = std::sqrt(a2 + (1 - a2) * ni * ni);
  const double ratio = facing * (no_ + spread_) / (no_ * si + ni * spread_);
  // With light and eye of unit length cosθ_h is half the length of their sum.
  const double w = std::max(1 - 0.5 * (i + eye_).norm(), 0.0), white = w * w * w * w * w;
  return {ratio * (lobe_.r + (1 - lobe_.r) * white), ratio * (lobe_.g + (1 - lobe_.g) * white),
          ratio * (lobe_.b + (1 - lobe_.b) * white)};
}

double LobeDistribution::pdf(const Vec3& i) const {
  if (!shines()) return 0;
  const double shape = lobe_.shape;
  if (lobe_.kind == LOBE_NONE) return std::max(normal_.dot(i), 0.0) / pi;
  if (lobe_.kind == LOBE_PHONG) return (shape + 1) / (2 * pi) * std::pow(std::max(axis_.dot(i), 0.0), shape);
  const Vec3 h = (i + eye_).normalized();
  if (!(normal_.dot(h) > 0)) return 0;
  const double a2 = shape * shape, d = a2 + (1 - a2) * normal_.cross(h).squaredNorm();
  return a2 / (pi * d * d) / (2 * (no_ + spread_));
}

Vec2 LobeDistribution::invert(const Vec3& i) const {
  if (lobe_.kind != LOBE_GGX) {
    const double cosine = axis_.dot(i);
    const double x = lobe_.kind == LOBE_NONE ? 1 - cosine * cosine
                                             : std::pow(std::max(cosine, 0.0), static_cast<double>(lobe_.shape) + 1);
    return {x, share_of_turn(along_.dot(i), across_.dot(i))};
  }
  const double alpha = lobe_.shape;
  const Vec3 m = (i + eye_).normalized();
  const Vec3 h = Vec3(across_.dot(m) / alpha, along_.dot(m) / alpha, normal_.dot(m)).normalized();
  const double a = h.dot(t1_), low = 0.5 * (1 + squeezed_.z());
  const double b = (h.dot(t2_) - (1 - low) * std::sqrt(std::max(1 - a * a, 0.0))) / low;
  return {a * a + b * b, share_of_turn(b, a)};
}

std::size_t lobe_table(PointSequence sequence, int n) {
  return static_cast<std::size_t>(sequence == PointSequence::twister ? std::max(table_stretches * n, least_table) : n);
}

std::vector<LobePoint> lobe_points(PointSequence sequence, int n, std::uint32_t seed, LobeDraws draws) {
  const auto kind = static_cast<std::uint32_t>(draws);
  std::vector<LobePoint> points;
  points.reserve(lobe_table(sequence, n));
  if (sequence == PointSequence::twister) {
    for (const UnitPoint& p : twister_points(static_cast<int>(lobe_table(sequence, n)), hash(seed + kind)))
      points.push_back(lobe_point(p.x + half_step, p.y + half_step));
    return points;
  }
  // Numbers that no cell has.
  const UnitPoint begin = cell_shift(seed, ~kind);
  for (int i = 0; i < n; ++i) {
    const double y = radical_inverse(2, static_cast<std::uint64_t>(i)) + begin.y + half_step;
    points.push_back(lobe_point((i + (begin.x + half_step)) / n, y - std::floor(y)));
  }
  return points;
}

std::vector<LobePoint> judging_points(int n) {
  constexpr int least = 1 << 12, most = 1 << 16;
  const int many = n < most / 16 ? std::max(16 * n, least) : std::max(most, n);
  return lobe_points(PointSequence::halton, many, 0, LobeDraws::glossy);
}

std::size_t first_point(PointSequence sequence, std::size_t points, std::uint32_t receiver, std::uint32_t seed,
                        LobeDraws draws) {
  if (sequence != PointSequence::twister) return 0;
  return hash(~static_cast<std::uint32_t>(draws), receiver, hash(seed)) % points;
}

LobeTurn lobe_turn(std::uint32_t receiver, std::uint32_t seed, LobeDraws draws) {
  // Numbers that neither a cell nor first_point has.
  const double angle = 2 * pi * unit(hash(~(static_cast<std::uint32_t>(draws) + 2), receiver, hash(seed)));
  return {std::cos(angle), std::sin(angle)};
}

LobePoint turned(const LobePoint& point, const LobeTurn& turn) {
  return {point.x, point.log_x, turn.cosine * point.cos_phi - turn.sine * point.sin_phi,
          turn.cosine * point.sin_phi + turn.sine * point.cos_phi};
}

}  // namespace lumifield
