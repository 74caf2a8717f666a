#pragma once

#include "luminaire/geometry.h"

namespace lumifield::virtual_bench {

/// Distance along a straight move against time: constant acceleration from an entry speed, cruise, constant
/// deceleration to rest. Where the length is too short for the cruise speed the peak is lower; where it is too short to
/// stop from the entry speed the deceleration is steeper. mm, s. Value type.
class Trapezoid {
 public:
  Trapezoid() = default;
  Trapezoid(double length_mm, double cruise_mm_s, double acceleration_mm_s2, double entry_mm_s = 0);

  double length_mm() const { return length_; }
  double duration_s() const { return speeding_up_s_ + cruising_s_ + slowing_down_s_; }
  double distance_mm(double time_s) const;
  double speed_mm_s(double time_s) const;

 private:
  double length_ = 0, entry_ = 0, peak_ = 0, up_ = 0, down_ = 0;
  double speeding_up_s_ = 0, cruising_s_ = 0, slowing_down_s_ = 0;
};

/// A straight line at one speed, and the time to wait at its end.
struct Move {
  Vec2 from_mm{0, 0}, to_mm{0, 0};
  double speed_mm_s = 0, acceleration_mm_s2 = 0;
  double dwell_s = 0;
  Trapezoid profile() const { return Trapezoid((to_mm - from_mm).norm(), speed_mm_s, acceleration_mm_s2); }
};

/// The largest value along `direction` that keeps each axis within its own: min over axes of limit / |component|.
double limited_along(const Vec2& direction, const Vec2& axis_limit);

}  // namespace lumifield::virtual_bench
