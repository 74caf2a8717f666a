#include "acquisition/virtual/motion.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace lumifield::virtual_bench {

Trapezoid::Trapezoid(double length_mm, double cruise_mm_s, double acceleration_mm_s2) {
  if (length_mm <= 0) return;
  const double peak = std::min(cruise_mm_s, std::sqrt(acceleration_mm_s2 * length_mm));
  const double ramp_s = peak / acceleration_mm_s2, cruise_s = std::max(0.0, length_mm / peak - ramp_s);
  length_ = length_mm;
  phases_ = {{{ramp_s, acceleration_mm_s2}, {cruise_s, 0}, {ramp_s, -acceleration_mm_s2}}};
}

Trapezoid Trapezoid::braking(double speed_mm_s, double acceleration_mm_s2) {
  Trapezoid stop;
  stop.length_ = speed_mm_s * speed_mm_s / (2 * acceleration_mm_s2);
  stop.entry_ = speed_mm_s;
  stop.phases_[2] = {speed_mm_s / acceleration_mm_s2, -acceleration_mm_s2};
  return stop;
}

Trapezoid::Point Trapezoid::at(double time_s) const {
  if (time_s >= duration_s()) return {length_, 0};
  Point point{0, entry_};
  for (const Phase& phase : phases_) {
    const double t = std::clamp(time_s, 0.0, phase.s);
    point = {point.mm + (point.mm_s + phase.mm_s2 * t / 2) * t, point.mm_s + phase.mm_s2 * t};
    time_s -= t;
  }
  return point;
}

void Axes::push(const Move& move) {
  queue_.push_back(move);
  if (queue_.size() > 1) return;
  time_s_ = 0;
  begin_front();
}

void Axes::begin_front() {
  const Move& move = queue_.front();
  profile_ = Trapezoid((move.to_mm - move.from_mm).norm(), move.speed_mm_s, move.acceleration_mm_s2);
  travelled_mm_ = 0;
  lost_per_mm_ = profile_.length_mm() > 0 ? loss_mm(move) / profile_.length_mm() : 0;
}

double Axes::loss_mm(const Move& move) const { return (move.to_mm - move.from_mm).norm() > 2 ? lost_mm_per_move : 0; }

void Axes::travel_to(double distance_mm) {
  const Move& move = queue_.front();
  offset_mm_ -= move.direction() * lost_per_mm_ * (distance_mm - travelled_mm_);
  play_mm_ = play_after(play_mm_, move.direction() * (distance_mm - travelled_mm_));
  claimed_mm_ = move.from_mm + move.direction() * distance_mm;
  travelled_mm_ = distance_mm;
}

Vec2 Axes::play_after(const Vec2& play_mm, const Vec2& way_mm) const {
  return (play_mm - way_mm).cwiseMax(Vec2::Zero()).cwiseMin(Vec2::Constant(backlash_mm));
}

void Axes::advance(double seconds) {
  if (stuck || held()) return;
  time_s_ += seconds;
  while (!queue_.empty()) {
    Move& move = queue_.front();
    travel_to(profile_.at(time_s_).mm);
    const double end_s = profile_.duration_s() + (stopping() ? 0 : move.dwell_s);
    if (time_s_ < end_s) return;

    // Stopped on the way: what is left is a move from rest.
    if (stopping()) {
      hold_ = Hold::held;
      move.from_mm = claimed_mm_;
      return;
    }
    time_s_ -= end_s;
    claimed_mm_ = move.to_mm;
    queue_.pop_front();
    if (!queue_.empty()) begin_front();
  }
}

void Axes::hold() {
  if (hold_ != Hold::none) return;
  hold_ = queue_.empty() ? Hold::held : Hold::stopping;
  if (queue_.empty()) return;
  Move& move = queue_.front();
  profile_ = Trapezoid::braking(profile_.at(time_s_).mm_s, move.acceleration_mm_s2);
  move.from_mm = claimed_mm_;
  time_s_ = travelled_mm_ = 0;
}

void Axes::resume() {
  if (!held()) return;
  hold_ = Hold::none;
  time_s_ = 0;
  if (queue_.empty()) return;
  const double rate = lost_per_mm_;
  begin_front();
  lost_per_mm_ = rate;
}

void Axes::kill() {
  queue_.clear();
  hold_ = Hold::none;
}

Vec2 Axes::true_target_mm() const {
  Vec2 target = target_mm() + offset_mm_, at = claimed_mm_, play = play_mm_;
  for (const Move& move : queue_) {
    target -= move.direction() * loss_mm(move);
    play = play_after(play, move.to_mm - at);
    at = move.to_mm;
  }
  return target + play;
}

void Axes::stands_at(const Vec2& true_mm, const Vec2& claimed_mm) {
  claimed_mm_ = claimed_mm;
  offset_mm_ = true_mm - claimed_mm - play_mm_;
}

}  // namespace lumifield::virtual_bench
