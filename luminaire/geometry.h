#pragma once

#include <Eigen/Core>

namespace lumifield {

using Vec2 = Eigen::Vector2d;
using Vec3 = Eigen::Vector3d;

/// Rigid or affine placement: 4x4, double, millimetres, acts on column vectors, stored row by row in files.
using Pose = Eigen::Matrix4d;

inline Vec3 transform_point(const Pose& pose, const Vec3& p) {
  return pose.topLeftCorner<3, 3>() * p + pose.topRightCorner<3, 1>();
}
inline Vec3 transform_direction(const Pose& pose, const Vec3& d) { return pose.topLeftCorner<3, 3>() * d; }

}  // namespace lumifield
