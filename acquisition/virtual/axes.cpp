#include "acquisition/virtual/axes.h"

namespace lumifield::virtual_bench {

namespace {
Vec2 direction(const Move& move) {
  const Vec2 way = move.to_mm - move.from_mm;
  return way.norm() > 0 ? Vec2(way.normalized()) : Vec2(Vec2::Zero());
}
}  // namespace

void Axes::push(const Move& move) {
  queue_.push_back(move);
  if (queue_.size() == 1) {
    time_s_ = 0;
    begin_front();
  }
}

void Axes::begin_front() {
  profile_ = queue_.front().profile();
  travelled_mm_ = 0;
  lost_per_mm_ = profile_.length_mm() > 0 ? lost_mm_per_move / profile_.length_mm() : 0;
}

void Axes::travel_to(double distance_mm) {
  const Move& move = queue_.front();
  offset_mm_ -= direction(move) * lost_per_mm_ * (distance_mm - travelled_mm_);
  claimed_mm_ = move.from_mm + direction(move) * distance_mm;
  travelled_mm_ = distance_mm;
}

void Axes::advance(double seconds) {
  if (stuck || held()) return;
  time_s_ += seconds;
  while (!queue_.empty()) {
    Move& move = queue_.front();
    travel_to(profile_.distance_mm(time_s_));
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
  if (queue_.empty()) {
    hold_ = Hold::held;
    return;
  }
  Move& move = queue_.front();
  const double speed = profile_.speed_mm_s(time_s_);
  const double left = profile_.length_mm() - travelled_mm_;
  const double way = std::min(left, speed * speed / (2 * move.acceleration_mm_s2));
  move.from_mm = claimed_mm_;
  travelled_mm_ = 0;
  profile_ = Trapezoid(way, speed, move.acceleration_mm_s2, speed);
  time_s_ = 0;
  hold_ = Hold::stopping;
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
  Vec2 target = target_mm() + offset_mm_;
  for (const Move& move : queue_) target -= direction(move) * lost_mm_per_move;
  return target;
}

double Axes::speed_mm_s() const { return queue_.empty() || held() ? 0 : profile_.speed_mm_s(time_s_); }

void Axes::reference(const Vec2& claimed_mm) {
  claimed_mm_ = claimed_mm;
  offset_mm_ = Vec2::Zero();
}

}  // namespace lumifield::virtual_bench
