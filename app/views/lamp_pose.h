#pragma once

#include "luminaire/geometry.h"

namespace lumifield {

/// Poses of lamps, luminaire frame → scene frame, mm: what is changed stays rigid to rounding, however often. `pivot`
/// is the point of the lamp, in its own frame, that stays where it is when it turns. `up` is the scene's, of any
/// length. Pure functions.

/// Where the beam (+z) points: yaw about up, counter-clockwise seen from above, from the first of upright_axes(up);
/// pitch above the horizon. Roll turns the lamp about its beam from where its x axis is level and its y axis points
/// upwards, from x to y. A beam along up has no yaw of its own: its roll is 0.
struct LampAngles {
  double yaw_deg = 0;    ///< −180 … 180
  double pitch_deg = 0;  ///< −90 … 90
  double roll_deg = 0;   ///< −180 … 180
};
LampAngles angles_of(const Pose& pose, const Vec3& up);
/// Any angles: those of angles_of again mean the same placement.
Pose with_angles(const Pose& pose, const Vec3& pivot, const LampAngles& angles, const Vec3& up);

/// The beam points along `direction`, and the lamp keeps its roll: a level one stays level. One whose beam is within
/// pole_deg of up or down is turned by the shortest way; others are not turned nearer than `nearest_deg` to it.
Pose with_beam(const Pose& pose, const Vec3& pivot, const Vec3& direction, const Vec3& up);
inline constexpr double pole_deg = 1, nearest_deg = 0.1;

Pose shifted(const Pose& pose, const Vec3& shift_mm);
/// Its rotation made orthonormal again.
Pose rigid(const Pose& pose);

inline Vec3 beam_of(const Pose& pose) { return pose.block<3, 1>(0, 2); }

}  // namespace lumifield
