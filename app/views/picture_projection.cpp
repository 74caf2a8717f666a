#include "app/views/picture_projection.h"

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

namespace lumifield {

PictureProjection::PictureProjection(const SceneCamera& camera, const Vec2& corner_px, const Vec2& size_px)
    : eye_(camera.position_mm),
      forward_((camera.target_mm - camera.position_mm).normalized()),
      corner_(corner_px),
      size_(size_px),
      scale_(2 * std::tan(camera.fov_y_deg * std::numbers::pi / 360) / size_px.y()) {
  right_ = forward_.cross(camera.up).normalized();
  up_ = right_.cross(forward_);
}

std::optional<Vec2> PictureProjection::to_px(const Vec3& point_mm) const {
  const Vec3 seen = point_mm - eye_;
  const double depth = seen.dot(forward_);
  if (!(depth > 1e-9 * seen.norm())) return {};
  return corner_ + size_ / 2 + Vec2(seen.dot(right_), -seen.dot(up_)) / (scale_ * depth);
}

Vec3 PictureProjection::ray(const Vec2& px) const {
  const Vec2 off = scale_ * (px - corner_ - size_ / 2);
  return (forward_ + off.x() * right_ - off.y() * up_).normalized();
}

}  // namespace lumifield
