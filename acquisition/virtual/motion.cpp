#include "acquisition/virtual/motion.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lumifield::virtual_bench {

Trapezoid::Trapezoid(double length_mm, double cruise_mm_s, double acceleration_mm_s2, double entry_mm_s)
    : length_(length_mm), entry_(entry_mm_s), up_(acceleration_mm_s2), down_(acceleration_mm_s2) {
  if (length_ <= 0) {
    length_ = entry_ = 0;
    return;
  }
  // Peak speed: v² = a L + v0²/2 where the move has no cruise.
  peak_ = std::min(std::max(cruise_mm_s, entry_), std::sqrt(up_ * length_ + entry_ * entry_ / 2));
  if (peak_ <= entry_) {
    peak_ = entry_;
    down_ = std::max(down_, peak_ * peak_ / (2 * length_));
  }
  speeding_up_s_ = (peak_ - entry_) / up_;
  slowing_down_s_ = peak_ / down_;
  const double ramps = (peak_ + entry_) / 2 * speeding_up_s_ + peak_ / 2 * slowing_down_s_;
  cruising_s_ = std::max(0.0, (length_ - ramps) / peak_);
}

double Trapezoid::distance_mm(double time_s) const {
  if (time_s >= duration_s()) return length_;
  const double up = std::clamp(time_s, 0.0, speeding_up_s_);
  const double cruise = std::clamp(time_s - speeding_up_s_, 0.0, cruising_s_);
  const double down = std::clamp(time_s - speeding_up_s_ - cruising_s_, 0.0, slowing_down_s_);
  return entry_ * up + up_ * up * up / 2 + peak_ * cruise + peak_ * down - down_ * down * down / 2;
}

double Trapezoid::speed_mm_s(double time_s) const {
  if (time_s >= duration_s()) return 0;
  if (time_s < speeding_up_s_) return entry_ + up_ * time_s;
  return peak_ - down_ * std::max(0.0, time_s - speeding_up_s_ - cruising_s_);
}

double limited_along(const Vec2& direction, const Vec2& axis_limit) {
  double limit = std::numeric_limits<double>::infinity();
  for (int axis = 0; axis < 2; ++axis)
    if (std::abs(direction[axis]) > 1e-9) limit = std::min(limit, axis_limit[axis] / std::abs(direction[axis]));
  return limit;
}

}  // namespace lumifield::virtual_bench
