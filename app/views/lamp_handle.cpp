#include "app/views/lamp_handle.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "app/views/lamp_pose.h"

namespace lumifield {
namespace {

double cross(const Vec2& a, const Vec2& b) { return a.x() * b.y() - a.y() * b.x(); }

/// Of the segment ab to p.
double distance(const Vec2& a, const Vec2& b, const Vec2& p) {
  const Vec2 along = b - a;
  const double length = along.squaredNorm();
  const double t = length > 0 ? std::clamp((p - a).dot(along) / length, 0.0, 1.0) : 0;
  return (p - a - t * along).norm();
}

/// Of the rectangle, 0 inside, and of the arrow's shaft.
double distance(const LampHandle& handle, const Vec2& p) {
  double nearest = distance(handle.centre, handle.tip, p);
  int left = 0, right = 0;
  for (std::size_t k = 0; k < 4; ++k) {
    const Vec2 &a = handle.outline[k], &b = handle.outline[(k + 1) % 4];
    nearest = std::min(nearest, distance(a, b, p));
    const double side = cross(b - a, p - a);
    left += side > 0;
    right += side < 0;
  }
  return left == 4 || right == 4 ? 0 : nearest;
}

bool meets(const LampHandle& handle, const Vec2& corner, const Vec2& size) {
  Vec2 low = handle.outline[0], high = low;
  for (const Vec2& p : handle.outline) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  return (low.array() <= (corner + size).array()).all() && (high.array() >= corner.array()).all();
}

}  // namespace

LampShape shape_of(const Sampling& sampling) {
  return {sampling.center_mm,
          Vec2(sampling.columns * sampling.spacing_mm.x(), sampling.rows * sampling.spacing_mm.y()) / 2};
}

double arrow_mm(const PictureProjection& view, const ScenePlacement& lamp, const LampShape& shape) {
  const Vec3 centre = transform_point(lamp.pose, shape.pivot());
  return std::max(arrow_px * view.mm_per_px(centre), 2 * shape.half_mm.maxCoeff());
}

std::optional<LampHandle> handle_of(const PictureProjection& view, int number, const ScenePlacement& lamp,
                                    const LampShape& shape) {
  LampHandle handle;
  handle.lamp = number;
  constexpr std::array<std::array<int, 2>, 4> corners{{{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}};
  for (std::size_t k = 0; k < 4; ++k) {
    const Vec2 on_u = shape.centre_mm + shape.half_mm.cwiseProduct(Vec2(corners[k][0], corners[k][1]));
    const std::optional<Vec2> corner = view.to_px(transform_point(lamp.pose, {on_u.x(), on_u.y(), 0}));
    if (!corner) return {};
    handle.outline[k] = *corner;
  }
  const Vec3 centre = transform_point(lamp.pose, shape.pivot());
  handle.centre = view.to_px(centre).value_or(handle.outline[0]);
  handle.tip = view.to_px(centre + arrow_mm(view, lamp, shape) * beam_of(lamp.pose)).value_or(handle.centre);
  handle.towards_eye = (centre - view.eye_mm()).dot(beam_of(lamp.pose)) < 0;
  if (!meets(handle, view.corner_px(), view.size_px())) return {};
  return handle;
}

std::optional<LampHit> hit(const std::vector<LampHandle>& handles, const Vec2& px) {
  std::optional<LampHit> found;
  double nearest = reach_px;
  // A tip that stands upon its lamp is no place to grab.
  for (const LampHandle& handle : handles)
    if (const double away = (handle.tip - px).norm();
        away <= nearest && (handle.tip - handle.centre).norm() > 2 * reach_px) {
      nearest = away;
      found = LampHit{handle.lamp, LampPart::tip};
    }
  if (found) return found;
  for (const LampHandle& handle : handles)
    if (const double away = std::min(distance(handle, px), (handle.centre - px).norm()); away <= nearest) {
      nearest = away;
      found = LampHit{handle.lamp, LampPart::body};
    }
  return found;
}

Vec3 shift_across(const PictureProjection& view, const Vec3& point_mm, const Vec2& from, const Vec2& to) {
  const Vec2 moved = view.mm_per_px(point_mm) * (to - from);
  return moved.x() * view.right() - moved.y() * view.up();
}

std::optional<Vec3> shift_along(const PictureProjection& view, const Vec3& point_mm, const Vec3& direction,
                                const Vec2& from, const Vec2& to) {
  const std::optional<Vec2> stands = view.to_px(point_mm);
  if (!stands) return {};
  // Nearest to the ray o + s r: the foot on the line w + t d, seen from the eye.
  const Vec3 r = view.ray(*stands + to - from), d = direction.normalized(), w = point_mm - view.eye_mm();
  const double b = d.dot(r), across = 1 - b * b;
  constexpr double least = 0.003;
  if (across < least) return {};
  const double t = (b * w.dot(r) - w.dot(d)) / across;
  if (view.depth_mm(point_mm + t * d) <= 0) return {};
  return t * d;
}

std::optional<Vec3> beam_below(const PictureProjection& view, const Vec3& point_mm, const Vec3& beam, double length_mm,
                               const Vec2& from, const Vec2& to) {
  const Vec3 tip = point_mm + length_mm * beam;
  const std::optional<Vec2> stands = view.to_px(tip);
  if (!stands) return {};
  const bool near = view.ray(*stands).dot(beam) < 0;
  // The ray's nearest point to the lamp, and how far past it the sphere of tips is.
  const Vec3 ray = view.ray(*stands + to - from), w = point_mm - view.eye_mm();
  const Vec3 off = w.dot(ray) * ray - w;
  const double away = off.norm();
  if (away <= length_mm) {
    const double deep = std::sqrt(length_mm * length_mm - away * away);
    return ((off + (near ? -deep : deep) * ray) / length_mm).normalized();
  }
  const double around = std::min((away - length_mm) / length_mm, std::numbers::pi / 2);
  return (std::cos(around) * off / away + (near ? 1 : -1) * std::sin(around) * ray).normalized();
}

}  // namespace lumifield
