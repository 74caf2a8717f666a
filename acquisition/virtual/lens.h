#pragma once

#include <vector>

#include "luminaire/bench.h"

namespace lumifield::virtual_bench {

/// The camera's forward model, written apart from the product's. x = X/Z, y = Y/Z in the camera frame, r² = x² + y²,
///
///     x_d = x (1 + k1 r² + k2 r⁴ + k3 r⁶) + 2 p1 x y + p2 (r² + 2x²),   y_d alike with p1, p2 swapped,
///     pixel = (fx x_d + cx, fy y_d + cy)                                         (Brown 1966, Conrady 1919)

Vec2 distort(const CameraModel& camera, const Vec2& ideal);
/// Its inverse by x ← x + (x_d − distort(x)), which gains a digit a step on lenses as weak as ours.
Vec2 undistort(const CameraModel& camera, const Vec2& distorted);

/// Pixel coordinates of a point in front of the camera, bench frame.
Vec2 project(const CameraModel& camera, const Vec3& p_mm);

/// A camera that looks obliquely, from beyond and below, at the back of the translucent screen and sees the rectangle
/// ±half_view_mm around the axis with a small margin: clear of lamp and slide wherever the stage stands.
/// `optics`: through a real lens, else as an ideal pinhole.
CameraModel place_camera(int width_px, int height_px, double separation_mm, const Vec2& half_view_mm, bool optics);

/// The same camera with the real lens' distortion and vignetting, or without any.
CameraModel with_optics(CameraModel camera, bool optics);

/// Screen coordinates and relative illumination of every pixel centre, row by row; x is NaN where the ray misses.
struct LensMap {
  int width_px, height_px;
  std::vector<Eigen::Vector2f> screen_mm;
  std::vector<float> illumination;
};
LensMap make_lens_map(const CameraModel& camera, double separation_mm);

}  // namespace lumifield::virtual_bench
