#include "app/views/lamp_pose.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "app/views/orbit_camera.h"

namespace lumifield {
namespace {

constexpr double rad_per_deg = std::numbers::pi / 180;

/// The axes of a lamp of no roll, in upright axes.
Eigen::Matrix3d level_axes(double yaw, double pitch) {
  Eigen::Matrix3d axes;
  axes.col(2) = Vec3(std::cos(pitch) * std::cos(yaw), std::cos(pitch) * std::sin(yaw), std::sin(pitch));
  axes.col(0) = Vec3(-std::sin(yaw), std::cos(yaw), 0);
  axes.col(1) = axes.col(2).cross(axes.col(0));
  return axes;
}

Eigen::Matrix3d rotation_of(const LampAngles& angles) {
  const Eigen::AngleAxisd roll(angles.roll_deg * rad_per_deg, Vec3::UnitZ());
  return level_axes(angles.yaw_deg * rad_per_deg, angles.pitch_deg * rad_per_deg) * roll.toRotationMatrix();
}

Pose about(const Pose& pose, const Vec3& pivot, const Eigen::Matrix3d& rotation) {
  Pose turned = Pose::Identity();
  turned.topLeftCorner<3, 3>() = rotation;
  turned = rigid(turned);
  turned.topRightCorner<3, 1>() = transform_point(pose, pivot) - transform_direction(turned, pivot);
  return turned;
}

}  // namespace

LampAngles angles_of(const Pose& pose, const Vec3& up) {
  const Eigen::Matrix3d own = upright_axes(up).transpose() * rigid(pose).topLeftCorner<3, 3>();
  const Vec3 x = own.col(0), beam = own.col(2);
  const double level = std::hypot(beam.x(), beam.y());
  const double pitch = std::atan2(beam.z(), level);
  constexpr double along_up = 1e-9;
  if (level < along_up) {
    const double yaw = std::remainder(std::atan2(x.y(), x.x()) - std::numbers::pi / 2, 2 * std::numbers::pi);
    return {yaw / rad_per_deg, pitch / rad_per_deg, 0};
  }
  const double yaw = std::atan2(beam.y(), beam.x());
  const Eigen::Matrix3d axes = level_axes(yaw, pitch);
  const double roll = std::atan2(x.dot(axes.col(1)), x.dot(axes.col(0)));
  return {yaw / rad_per_deg, pitch / rad_per_deg, roll / rad_per_deg};
}

Pose with_angles(const Pose& pose, const Vec3& pivot, const LampAngles& angles, const Vec3& up) {
  return about(pose, pivot, upright_axes(up) * rotation_of(angles));
}

Pose with_beam(const Pose& pose, const Vec3& pivot, const Vec3& direction, const Vec3& up) {
  LampAngles angles = angles_of(pose, up);
  if (std::abs(angles.pitch_deg) > 90 - pole_deg) {
    const Eigen::Matrix3d before = rigid(pose).topLeftCorner<3, 3>();
    const Eigen::Quaterniond turn = Eigen::Quaterniond::FromTwoVectors(before.col(2), direction);
    return about(pose, pivot, turn.toRotationMatrix() * before);
  }
  const Vec3 beam = upright_axes(up).transpose() * direction.normalized();
  const double level = std::hypot(beam.x(), beam.y());
  if (level > 0) angles.yaw_deg = std::atan2(beam.y(), beam.x()) / rad_per_deg;
  angles.pitch_deg = std::clamp(std::atan2(beam.z(), level) / rad_per_deg, nearest_deg - 90, 90 - nearest_deg);
  return with_angles(pose, pivot, angles, up);
}

Pose shifted(const Pose& pose, const Vec3& shift_mm) {
  Pose moved = rigid(pose);
  moved.topRightCorner<3, 1>() += shift_mm;
  return moved;
}

Pose rigid(const Pose& pose) {
  Pose made = Pose::Identity();
  const Eigen::Matrix3d rotation = pose.topLeftCorner<3, 3>();
  made.topLeftCorner<3, 3>() = Eigen::Quaterniond(rotation).normalized().toRotationMatrix();
  made.topRightCorner<3, 1>() = pose.topRightCorner<3, 1>();
  return made;
}

}  // namespace lumifield
