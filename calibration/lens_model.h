#pragma once

#include <optional>

#include "luminaire/bench.h"
#include "luminaire/geometry.h"

namespace lumifield {

/// The bench file's camera model made to compute: pinhole with Brown–Conrady distortion (Brown 1966; coefficient order
/// of OpenCV) and radial relative illumination. Points are in the bench frame (mm), pixels have their centres at
/// integers, a *ray* is (x, y) of the undistorted direction (x, y, 1) in the camera frame.
///
/// The polynomial folds back beyond some field angle; only the branch through the axis counts, beyond it there is
/// nothing. Value type, immutable, safe from any thread.
class LensModel {
 public:
  explicit LensModel(const CameraModel& model);

  /// Pixel of a point; empty behind the camera or beyond the fold.
  std::optional<Vec2> project(const Vec3& bench_mm) const;

  /// Ray of a pixel by Newton's method from `start` (a neighbour's ray, else zero); empty beyond the fold.
  std::optional<Vec2> undistort(const Vec2& pixel, const Vec2& start = Vec2::Zero()) const;

  /// Where a ray meets the plane z = const of the bench frame; empty where it runs away from it.
  std::optional<Vec2> meet_plane(const Vec2& ray, double z_mm) const;

  /// V(ρ), ρ = |ray|.
  double relative_illumination(const Vec2& ray) const;

 private:
  Vec2 distort(const Vec2& ray, Eigen::Matrix2d* jacobian) const;

  CameraModel model_;
  Pose camera_to_bench_;
  double fold_squared_;  ///< ρ² from which on the radial polynomial decreases
};

}  // namespace lumifield
