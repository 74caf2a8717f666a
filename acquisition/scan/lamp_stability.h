#pragma once

#include <cmath>
#include <deque>
#include <optional>

#include "luminaire/plan.h"

namespace lumifield {

/// Readings in over_s, so that a lamp is seen to come to rest within a tenth.
inline constexpr double readings_over = 10;
/// Readings until the limit, the last one when it has passed.
inline double most_readings(const Stabilisation& wanted) {
  return std::ceil(wanted.limit_s / wanted.over_s * readings_over) + 2;
}

/// Whether a lamp that warms up is steady, by readings of its light: those of the last over_s spread by no more than
/// `within`, (largest − smallest)/smallest. It takes three readings at least, and one that is over_s old. Value type.
class LampStability {
 public:
  explicit LampStability(const Stabilisation& wanted) : wanted_(wanted) {}

  /// In the order of time, from any origin; the signal is above 0, in any unit.
  void add(double time_s, double signal);
  /// Absent before the second reading.
  std::optional<double> spread() const;
  bool steady() const;
  /// There are enough readings for a verdict, and one that is over_s old.
  bool judges() const;

 private:
  static constexpr std::size_t fewest = 3;
  struct Reading {
    double time_s, signal;
  };
  Stabilisation wanted_;
  std::deque<Reading> readings_;  ///< the youngest of those that are over_s old, and what came after it
};

}  // namespace lumifield
