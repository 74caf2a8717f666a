#pragma once

#include <array>
#include <deque>

#include "luminaire/geometry.h"

namespace lumifield::virtual_bench {

/// Distance along a straight move against time, from rest to rest: constant acceleration, cruise, constant
/// deceleration. Where the length is too short for the cruise speed the peak is lower. mm, s. Value type.
class Trapezoid {
 public:
  Trapezoid() = default;
  Trapezoid(double length_mm, double cruise_mm_s, double acceleration_mm_s2);
  /// From a speed to rest.
  static Trapezoid braking(double speed_mm_s, double acceleration_mm_s2);

  struct Point {
    double mm, mm_s;
  };
  Point at(double time_s) const;
  double length_mm() const { return length_; }
  double duration_s() const { return phases_[0].s + phases_[1].s + phases_[2].s; }

 private:
  struct Phase {
    double s = 0, mm_s2 = 0;
  };
  double length_ = 0, entry_ = 0;
  std::array<Phase, 3> phases_;
};

/// A straight line at one speed, and the time to wait at its end.
struct Move {
  Vec2 from_mm{0, 0}, to_mm{0, 0};
  double speed_mm_s = 0, acceleration_mm_s2 = 0;
  double dwell_s = 0;
  Vec2 direction() const { return (to_mm - from_mm).normalized(); }
};

/// The two motors behind a controller: a queue of moves, the position that their steps claim, and the carriage's true
/// position, which differs by what was never known (before homing) or was lost, and by the play of the drive: it rests
/// where it is until a motor that turns back has taken up the backlash. Driven upwards the play is 0. There is no
/// look-ahead: every move ends at rest. Thread-bound; the owner's clock drives advance().
///
///     empty ── push ──▶ moving ── hold ──▶ stopping ──▶ held ── resume ──▶ moving        kill: any ──▶ empty, at once
class Axes {
 public:
  explicit Axes(const Vec2& true_mm) : offset_mm_(true_mm) {}

  void advance(double seconds);

  void push(const Move& move);
  bool empty() const { return queue_.empty(); }
  int free_slots() const { return 15 - static_cast<int>(queue_.size()); }

  void hold();
  void resume();
  void kill();
  bool stopping() const { return hold_ == Hold::stopping; }
  bool held() const { return hold_ == Hold::held; }

  const Vec2& claimed_mm() const { return claimed_mm_; }
  Vec2 true_mm() const { return claimed_mm_ + offset_mm_ + play_mm_; }
  /// Where the queue ends: as claimed, and where the carriage will truly be.
  Vec2 target_mm() const { return queue_.empty() ? claimed_mm_ : queue_.back().to_mm; }
  Vec2 true_target_mm() const;
  double speed_mm_s() const { return queue_.empty() || held() ? 0 : profile_.at(time_s_).mm_s; }
  /// The carriage stands there, and that is what the steps now claim.
  void stands_at(const Vec2& true_mm, const Vec2& claimed_mm);

  /// Each move from now on falls short by this, but those of up to 2 mm: they never get fast enough to lose steps.
  double lost_mm_per_move = 0;
  bool stuck = false;      ///< time stands still for the motors
  double backlash_mm = 0;  ///< of either axis

 private:
  enum class Hold { none, stopping, held };
  void begin_front();
  void travel_to(double distance_mm);
  double loss_mm(const Move& move) const;
  Vec2 play_after(const Vec2& play_mm, const Vec2& way_mm) const;

  std::deque<Move> queue_;
  Trapezoid profile_;        // of the front move
  double time_s_ = 0;        // since the front move, or its deceleration, began
  double travelled_mm_ = 0;  // of the front move
  double lost_per_mm_ = 0;
  Hold hold_ = Hold::none;
  Vec2 claimed_mm_{0, 0}, offset_mm_, play_mm_{0, 0};
};

}  // namespace lumifield::virtual_bench
