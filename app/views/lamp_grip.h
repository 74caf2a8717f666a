#pragma once

#include <optional>
#include <vector>

#include "app/views/lamp_arrangement.h"

namespace lumifield {

/// Mouse and keys on the lamps of a picture: which one the cursor is at, and which one is held. A lamp that is grabbed
/// by its body moves across the view, or along its beam, or turns, as its user asks; by the tip of its arrow it turns.
/// What is held follows from the pose where it was grabbed, so that nothing adds up. GUI thread.
///
///     idle --grab--> held --drag--> moves --release--> idle (settled)
///                    held or moves --cancel--> idle (as it was)
class LampGrip {
 public:
  enum class Motion { across, along, turn };
  static constexpr double step_mm = 10, step_deg = 1;
  /// A cursor that goes no farther has chosen, not moved.
  static constexpr double slack_px = 3;

  explicit LampGrip(LampArrangement& lamps) : lamps_(lamps) {}

  std::vector<LampHandle> handles(const PictureProjection& view) const;
  /// What the cursor is at, or holds.
  const std::optional<LampHit>& at() const { return at_; }
  bool holds() const { return held_.has_value(); }
  bool moves() const { return held_ && held_->moves; }

  /// The cursor is there, or nowhere; true when it is at something else than before.
  bool point(const PictureProjection& view, const Vec2& px);
  bool point_away();
  /// Chooses and holds what is there; false when nothing is.
  bool grab(const PictureProjection& view, const Vec2& px, Motion motion);
  void drag(const Vec2& px);
  void release();
  /// As it was before; false when nothing is held.
  bool cancel();
  /// Forgets what is held; it stays where it is.
  void let_go() { held_.reset(); }

  /// The chosen lamp by one step: across the view, along its beam (up is on), or turned to its own left (right is
  /// negative) and upwards. False without one.
  bool step(const PictureProjection& view, Motion motion, int right, int up);

 private:
  struct Held {
    int lamp = 0;
    ScenePlacement before;
    Motion motion = Motion::across;
    PictureProjection view;
    Vec2 from;
    double arrow_mm = 0;
    bool moves = false;
  };
  std::optional<Pose> dragged(const Held& held, const Vec2& px) const;

  LampArrangement& lamps_;
  std::optional<LampHit> at_;
  std::optional<Held> held_;
};

}  // namespace lumifield
