#pragma once

#include <array>
#include <optional>
#include <vector>

#include "app/views/picture_projection.h"
#include "luminaire/light_field.h"

namespace lumifield {

/// What a lamp is grabbed by in the picture, and how it follows the cursor. Scene frame, mm; pixels of the projection.
/// Pure functions.

/// The emitting rectangle on U, luminaire frame: the grid's cells, each as large as their spacing.
struct LampShape {
  Vec2 centre_mm{0, 0}, half_mm{0, 0};
  Vec3 pivot() const { return {centre_mm.x(), centre_mm.y(), 0}; }
};
LampShape shape_of(const Sampling& sampling);

struct LampHandle {
  int lamp = 0;
  std::array<Vec2, 4> outline;  ///< of the rectangle, in turn
  Vec2 centre, tip;             ///< the arrow along the beam; the tip is at the centre where it would be behind the eye
  bool towards_eye = false;     ///< the beam, rather than away from it
};
/// As long as an arrow across the view is, px; never shorter than the lamp is wide.
inline constexpr double arrow_px = 64;
/// From centre to tip.
double arrow_mm(const PictureProjection& view, const ScenePlacement& lamp, const LampShape& shape);
/// Empty when the rectangle is not wholly before the eye, or nothing of it in the picture.
std::optional<LampHandle> handle_of(const PictureProjection& view, int number, const ScenePlacement& lamp,
                                    const LampShape& shape);

enum class LampPart { body, tip };
struct LampHit {
  int lamp = 0;
  LampPart part = LampPart::body;
  bool operator==(const LampHit&) const = default;
};
/// What a cursor within `reach_px` is at; the nearest, tips first.
std::optional<LampHit> hit(const std::vector<LampHandle>& handles, const Vec2& px);
inline constexpr double reach_px = 9;

/// Dragged from `from` to `to`, the shift that keeps the point below the cursor as it was: in the plane through it that
/// faces the eye.
Vec3 shift_across(const PictureProjection& view, const Vec3& point_mm, const Vec2& from, const Vec2& to);
/// The shift along `direction` that brings the point as near to the cursor as it comes. Empty where the direction
/// points within some 3° at the eye, or away from it, or the point would be behind the eye.
std::optional<Vec3> shift_along(const PictureProjection& view, const Vec3& point_mm, const Vec3& direction,
                                const Vec2& from, const Vec2& to);
/// The beam whose tip, `length_mm` from the point, stays below the cursor, on the side of the point where it is now;
/// a cursor beyond the reach of the tip takes it around to the other side, at the same speed. Of length 1. Empty where
/// the tip is behind the eye.
std::optional<Vec3> beam_below(const PictureProjection& view, const Vec3& point_mm, const Vec3& beam, double length_mm,
                               const Vec2& from, const Vec2& to);

}  // namespace lumifield
