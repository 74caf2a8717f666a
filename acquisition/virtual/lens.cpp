#include "acquisition/virtual/lens.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

namespace lumifield::virtual_bench {

Vec2 distort(const CameraModel& camera, const Vec2& ideal) {
  const auto [k1, k2, p1, p2, k3] = camera.distortion;
  const double x = ideal.x(), y = ideal.y(), r2 = ideal.squaredNorm();
  const double radial = 1 + r2 * (k1 + r2 * (k2 + r2 * k3));
  return {x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x), y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y};
}

Vec2 undistort(const CameraModel& camera, const Vec2& distorted) {
  Vec2 ideal = distorted, step;
  int steps = 0;
  do {
    step = distorted - distort(camera, ideal);
    ideal += step;
  } while (step.squaredNorm() > 1e-24 && ++steps < 100);
  return ideal;
}

Vec2 project(const CameraModel& camera, const Vec3& p_mm) {
  const Vec3 q = transform_point(camera.pose, p_mm);
  const Vec2 d = distort(camera, q.head<2>() / q.z());
  return {camera.fx * d.x() + camera.cx, camera.fy * d.y() + camera.cy};
}

namespace {

Pose look_at(const Vec3& eye, const Vec3& target, double roll) {
  const Vec3 forward = (target - eye).normalized();
  const Vec3 level = forward.cross(Vec3(0, 1, 0)).normalized(), below = forward.cross(level);
  Eigen::Matrix3d rotation;
  rotation.row(0) = std::cos(roll) * level + std::sin(roll) * below;
  rotation.row(1) = std::cos(roll) * below - std::sin(roll) * level;
  rotation.row(2) = forward;
  Pose pose = Pose::Identity();
  pose.topLeftCorner<3, 3>() = rotation;
  pose.topRightCorner<3, 1>() = -rotation * eye;
  return pose;
}

bool sees(const CameraModel& camera, double separation_mm, const Vec2& half_view_mm) {
  const Eigen::Array2d last(camera.width_px - 1, camera.height_px - 1), margin = 0.015 * (last + 1);
  for (int i = -4; i <= 4; ++i)
    for (int j = -4; j <= 4; ++j) {
      const Vec3 corner(half_view_mm.x() * i / 4, half_view_mm.y() * j / 4, separation_mm);
      const Eigen::Array2d pixel = project(camera, corner).array();
      if ((pixel < margin).any() || (pixel > last - margin).any()) return false;
    }
  return true;
}

}  // namespace

CameraModel place_camera(int width_px, int height_px, double separation_mm, const Vec2& half_view_mm, bool optics) {
  CameraModel camera;
  camera.width_px = width_px;
  camera.height_px = height_px;
  const double scale = std::min(width_px / 1024.0, height_px / 768.0);
  camera.fx = 1752.5 * scale;
  camera.fy = 1749.0 * scale;
  camera.cx = width_px / 2.0 + 6.3 * scale;
  camera.cy = height_px / 2.0 - 4.8 * scale;
  camera = with_optics(camera, optics);

  // Step back along a line 32° off the normal until the view fits.
  const Vec3 target(0, 0, separation_mm), direction = Vec3(0.18, -0.50, 0.85).normalized();
  for (double distance = 400; distance < 20000; distance *= 1.01) {
    camera.pose = look_at(target + distance * direction, target, 0.03);
    if (sees(camera, separation_mm, half_view_mm)) break;
  }
  return camera;
}

CameraModel with_optics(CameraModel camera, bool optics) {
  camera.distortion = {};
  camera.vignetting = {};
  if (!optics) return camera;
  camera.distortion = {-0.24, 0.12, 8e-4, -5e-4, 0.03};
  camera.vignetting = {-0.9, 0.5, -0.2};
  return camera;
}

LensMap make_lens_map(const CameraModel& camera, double separation_mm) {
  const Eigen::Matrix3d to_bench = camera.pose.topLeftCorner<3, 3>().transpose();
  const Vec3 eye = -to_bench * camera.pose.topRightCorner<3, 1>();
  const auto [v1, v2, v3] = camera.vignetting;
  LensMap map{camera.width_px, camera.height_px, {}, {}};
  map.screen_mm.reserve(static_cast<std::size_t>(camera.width_px) * camera.height_px);
  map.illumination.reserve(map.screen_mm.capacity());
  for (int j = 0; j < camera.height_px; ++j)
    for (int i = 0; i < camera.width_px; ++i) {
      const Vec2 ideal = undistort(camera, Vec2((i - camera.cx) / camera.fx, (j - camera.cy) / camera.fy));
      const Vec3 ray = to_bench * ideal.homogeneous();
      const double distance = (separation_mm - eye.z()) / ray.z(), r2 = ideal.squaredNorm();
      const double seen = distance > 0 ? distance : std::numeric_limits<double>::quiet_NaN();
      map.screen_mm.push_back((eye + seen * ray).head<2>().cast<float>());
      map.illumination.push_back(static_cast<float>(1 + r2 * (v1 + r2 * (v2 + r2 * v3))));
    }
  return map;
}

}  // namespace lumifield::virtual_bench
