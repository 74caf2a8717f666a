#include "app/views/orbit_camera.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace lumifield {
namespace {

constexpr double rad_per_deg = std::numbers::pi / 180;

}  // namespace

Eigen::Matrix3d upright_axes(const Vec3& up) {
  const Vec3 z = up.normalized();
  const Vec3 start = std::abs(z.x()) <= 0.9 ? Vec3::UnitX() : Vec3::UnitY();
  Eigen::Matrix3d axes;
  axes.col(2) = z;
  axes.col(0) = (start - start.dot(z) * z).normalized();
  axes.col(1) = z.cross(axes.col(0));
  return axes;
}

OrbitCamera::OrbitCamera(const SceneCamera& home) : home_(home) { reset(); }

void OrbitCamera::reset() {
  const Vec3 eye = upright_axes(home_.up).transpose() * (home_.position_mm - home_.target_mm);
  target_mm_ = home_.target_mm;
  distance_mm_ = eye.norm();
  azimuth_ = std::atan2(eye.y(), eye.x());
  elevation_ = std::atan2(eye.z(), std::hypot(eye.x(), eye.y()));
}

double OrbitCamera::azimuth_deg() const { return azimuth_ / rad_per_deg; }
double OrbitCamera::elevation_deg() const { return elevation_ / rad_per_deg; }

OrbitCamera::Axes OrbitCamera::axes() const {
  const Eigen::Matrix3d upright = upright_axes(home_.up);
  const Vec3 level = std::cos(azimuth_) * upright.col(0) + std::sin(azimuth_) * upright.col(1);
  Axes a;
  a.towards_eye = std::cos(elevation_) * level + std::sin(elevation_) * upright.col(2);
  a.right = upright.col(2).cross(level);
  a.up = a.towards_eye.cross(a.right);
  return a;
}

SceneCamera OrbitCamera::camera() const {
  return {target_mm_ + distance_mm_ * axes().towards_eye, target_mm_, home_.up, home_.fov_y_deg};
}

void OrbitCamera::orbit(double azimuth_deg, double elevation_deg) {
  constexpr double highest = highest_elevation_deg * rad_per_deg;
  azimuth_ = std::remainder(azimuth_ + azimuth_deg * rad_per_deg, 2 * std::numbers::pi);
  elevation_ = std::clamp(elevation_ + elevation_deg * rad_per_deg, -highest, highest);
}

double OrbitCamera::mm_per_px(double height_px) const {
  return 2 * distance_mm_ * std::tan(home_.fov_y_deg / 2 * rad_per_deg) / height_px;
}

void OrbitCamera::pan(double dx_px, double dy_px, double height_px) {
  const Axes a = axes();
  target_mm_ += mm_per_px(height_px) * (dy_px * a.up - dx_px * a.right);
}

void OrbitCamera::zoom(double steps, const Vec2& cursor_px, double height_px) {
  // The whole camera shrinks towards the point under the cursor.
  const double home = (home_.position_mm - home_.target_mm).norm();
  const double wanted = distance_mm_ * std::pow(zoom_per_step, -steps);
  const double factor = std::clamp(wanted, nearest_share * home, farthest_share * home) / distance_mm_;
  const Axes a = axes();
  const Vec3 under_cursor = target_mm_ + mm_per_px(height_px) * (cursor_px.x() * a.right - cursor_px.y() * a.up);
  target_mm_ = under_cursor + factor * (target_mm_ - under_cursor);
  distance_mm_ *= factor;
}

}  // namespace lumifield
