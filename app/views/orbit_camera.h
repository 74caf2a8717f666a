#pragma once

#include "luminaire/geometry.h"
#include "luminaire/scene.h"

namespace lumifield {

/// Right-handed axes whose third is along `up`, of any length; x and y themselves for up = z.
Eigen::Matrix3d upright_axes(const Vec3& up);

/// A camera on a sphere around its target: the direction from target to eye is given by azimuth (about the scene's up,
/// counter-clockwise seen from above) and elevation. Up is any direction; the view's up and angle stay the scene's.
/// Pixels are those of the shown picture, x to the right, y down; any pixel will do as long as the height is given in
/// the same. Scene frame, mm. Value type.
class OrbitCamera {
 public:
  /// Orbiting stops this short of looking along up.
  static constexpr double highest_elevation_deg = 89;
  /// Zooming keeps the distance within these multiples of the home camera's.
  static constexpr double nearest_share = 0.01, farthest_share = 20;
  /// One step nearer shortens the distance by this factor.
  static constexpr double zoom_per_step = 1.15;

  OrbitCamera() : OrbitCamera(SceneCamera{{0, -1000, 0}, {0, 0, 0}, {0, 0, 1}, 45}) {}
  /// Starts at the scene's own camera, where `reset` comes back to. Its position is not its target.
  explicit OrbitCamera(const SceneCamera& home);

  SceneCamera camera() const;
  const Vec3& target_mm() const { return target_mm_; }
  double distance_mm() const { return distance_mm_; }
  double azimuth_deg() const;    ///< −180 … 180
  double elevation_deg() const;  ///< −90 … 90

  void reset();
  /// Turns the eye about the target.
  void orbit(double azimuth_deg, double elevation_deg);
  /// Moves eye and target alike so that what is seen at the target's depth follows the cursor by (dx, dy).
  void pan(double dx_px, double dy_px, double height_px);
  /// Moves `steps` nearer (negative: away), keeping the point at the target's depth under the cursor where it is.
  /// `cursor_px` counts from the picture's centre.
  void zoom(double steps, const Vec2& cursor_px, double height_px);

 private:
  struct Axes {
    Vec3 towards_eye, right, up;
  };
  Axes axes() const;
  double mm_per_px(double height_px) const;

  SceneCamera home_;
  Vec3 target_mm_{0, 0, 0};
  double distance_mm_ = 0, azimuth_ = 0, elevation_ = 0;  ///< radians
};

}  // namespace lumifield
