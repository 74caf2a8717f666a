#pragma once

#include <deque>

#include "acquisition/virtual/motion.h"

namespace lumifield::virtual_bench {

/// The two motors behind a controller: a queue of moves, the position that their steps claim, and the carriage's true
/// position, which differs by what was never known (before homing) or was lost. There is no look-ahead: every move ends
/// at rest. Thread-bound; the owner's clock drives advance().
///
///     empty ── push ──▶ moving ── hold ──▶ stopping ──▶ held ── resume ──▶ moving        kill: any ──▶ empty, at once
class Axes {
 public:
  static constexpr int kQueueLength = 15;

  explicit Axes(const Vec2& true_mm) : offset_mm_(true_mm) {}

  void advance(double seconds);

  void push(const Move& move);
  bool full() const { return int(queue_.size()) >= kQueueLength; }
  bool empty() const { return queue_.empty(); }
  int free_slots() const { return kQueueLength - int(queue_.size()); }
  const Move& front() const { return queue_.front(); }

  void hold();
  void resume();
  void kill();
  bool stopping() const { return hold_ == Hold::stopping; }
  bool held() const { return hold_ == Hold::held; }

  const Vec2& claimed_mm() const { return claimed_mm_; }
  Vec2 true_mm() const { return claimed_mm_ + offset_mm_; }
  /// Where the queue ends: as claimed, and where the carriage will truly be.
  Vec2 target_mm() const { return queue_.empty() ? claimed_mm_ : queue_.back().to_mm; }
  Vec2 true_target_mm() const;
  double speed_mm_s() const;

  /// The claimed position becomes the true one, counted from `origin`.
  void reference(const Vec2& claimed_mm);
  /// The carriage stands against an end stop there, whatever the steps claim.
  void blocked_at(const Vec2& true_mm) { offset_mm_ = true_mm - claimed_mm_; }

  double lost_mm_per_move = 0;  ///< each move from now on falls short by this
  bool stuck = false;           ///< time stands still for the motors

 private:
  enum class Hold { none, stopping, held };
  void travel_to(double distance_mm);

  std::deque<Move> queue_;
  Trapezoid profile_;        // of the front move
  double time_s_ = 0;        // since the front move, or its deceleration, began
  double travelled_mm_ = 0;  // of the front move
  double lost_per_mm_ = 0;
  Hold hold_ = Hold::none;
  Vec2 claimed_mm_{0, 0}, offset_mm_;

  void begin_front();
};

}  // namespace lumifield::virtual_bench
