#include "calibration/lens_model.h"

#include <Eigen/LU>
#include <cmath>
#include <limits>

namespace lumifield {
namespace {

/// Smallest s = ρ² where d/dρ [ρ (1 + k1 s + k2 s² + k3 s³)] is no longer positive, sought up to ρ = 10 (84°).
double find_fold(const std::array<double, 5>& distortion) {
  const auto slope = [k1 = distortion[0], k2 = distortion[1], k3 = distortion[4]](double s) {
    return 1 + s * (3 * k1 + s * (5 * k2 + s * 7 * k3));
  };
  constexpr double step = 1e-3;
  for (double rho = step; rho < 10; rho += step)
    if (!(slope(rho * rho) > 0)) return (rho - step) * (rho - step);
  return std::numeric_limits<double>::infinity();
}

}  // namespace

LensModel::LensModel(const CameraModel& model)
    : model_(model), camera_to_bench_(model.pose.inverse()), fold_squared_(find_fold(model.distortion)) {}

Vec2 LensModel::distort(const Vec2& ray, Eigen::Matrix2d* jacobian) const {
  const auto [k1, k2, p1, p2, k3] = model_.distortion;
  const double x = ray.x(), y = ray.y(), s = x * x + y * y;
  const double radial = 1 + s * (k1 + s * (k2 + s * k3));
  if (jacobian) {
    const double slope = 2 * (k1 + s * (2 * k2 + s * 3 * k3));
    const double cross = x * y * slope + 2 * p1 * x + 2 * p2 * y;
    *jacobian << radial + x * x * slope + 2 * p1 * y + 6 * p2 * x, cross, cross,
        radial + y * y * slope + 6 * p1 * y + 2 * p2 * x;
  }
  return {x * radial + 2 * p1 * x * y + p2 * (s + 2 * x * x), y * radial + p1 * (s + 2 * y * y) + 2 * p2 * x * y};
}

std::optional<Vec2> LensModel::project(const Vec3& bench_mm) const {
  const Vec3 c = transform_point(model_.pose, bench_mm);
  if (!(c.z() > 0)) return std::nullopt;
  const Vec2 ray = c.head<2>() / c.z();
  if (!(ray.squaredNorm() < fold_squared_)) return std::nullopt;
  const Vec2 distorted = distort(ray, nullptr);
  return Vec2(model_.fx * distorted.x() + model_.cx, model_.fy * distorted.y() + model_.cy);
}

std::optional<Vec2> LensModel::undistort(const Vec2& pixel, const Vec2& start) const {
  const Vec2 target((pixel.x() - model_.cx) / model_.fx, (pixel.y() - model_.cy) / model_.fy);
  Vec2 ray = start;
  for (int iteration = 0; iteration < 30; ++iteration) {
    Eigen::Matrix2d slope;
    const Vec2 residual = target - distort(ray, &slope);
    const double determinant = slope(0, 0) * slope(1, 1) - slope(0, 1) * slope(1, 0);
    if (!(determinant > 0)) return std::nullopt;
    const Vec2 step = Vec2(slope(1, 1) * residual.x() - slope(0, 1) * residual.y(),
                           slope(0, 0) * residual.y() - slope(1, 0) * residual.x()) /
                      determinant;
    ray += step;
    // Quadratic convergence: a step of 1e-8 leaves 1e-16
    if (step.squaredNorm() < 1e-16 * (1 + ray.squaredNorm())) {
      if (!(ray.squaredNorm() < fold_squared_)) return std::nullopt;
      return ray;
    }
  }
  return std::nullopt;
}

std::optional<Vec2> LensModel::meet_plane(const Vec2& ray, double z_mm) const {
  const Vec3 eye = camera_to_bench_.topRightCorner<3, 1>();
  const Vec3 direction = transform_direction(camera_to_bench_, Vec3(ray.x(), ray.y(), 1));
  const double along = (z_mm - eye.z()) / direction.z();
  if (!(along > 0) || !std::isfinite(along)) return std::nullopt;
  return Vec2((eye + along * direction).head<2>());
}

double LensModel::relative_illumination(const Vec2& ray) const {
  const auto [v1, v2, v3] = model_.vignetting;
  const double s = ray.squaredNorm();
  return 1 + s * (v1 + s * (v2 + s * v3));
}

}  // namespace lumifield
