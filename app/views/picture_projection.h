#pragma once

#include <optional>

#include "luminaire/geometry.h"
#include "luminaire/scene.h"

namespace lumifield {

/// Where the points of a scene stand in its picture, and the rays of the picture's points: the renderer's pinhole
/// camera, whose pixels are square. Scene frame, mm; pixels of any size, x to the right, y down. Value type.
class PictureProjection {
 public:
  /// The picture's upper left corner and its size, px. The camera's position is off its target, up not along the view.
  PictureProjection(const SceneCamera& camera, const Vec2& corner_px, const Vec2& size_px);

  /// Empty behind the eye, or beside it.
  std::optional<Vec2> to_px(const Vec3& point_mm) const;
  /// From the eye, of length 1.
  Vec3 ray(const Vec2& px) const;
  /// In the plane through the point that faces the eye.
  double mm_per_px(const Vec3& point_mm) const { return scale_ * depth_mm(point_mm); }
  double depth_mm(const Vec3& point_mm) const { return (point_mm - eye_).dot(forward_); }

  const Vec3& eye_mm() const { return eye_; }
  const Vec3& right() const { return right_; }
  const Vec3& up() const { return up_; }
  const Vec3& forward() const { return forward_; }
  const Vec2& corner_px() const { return corner_; }
  const Vec2& size_px() const { return size_; }

 private:
  Vec3 eye_, right_, up_, forward_;
  Vec2 corner_, size_;
  double scale_;  ///< mm a pixel at a depth of 1 mm
};

}  // namespace lumifield
