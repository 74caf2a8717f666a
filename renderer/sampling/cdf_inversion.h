#pragma once

#include <algorithm>
#include <cmath>

namespace lumifield {

/// How a cumulative function that is linear between whole numbers is inverted (Lu, Pacanowski, Granier 2015, Sec. 5).
/// The modified secant looks where a line through the ends of the bracket crosses y, at both ends of the linear piece
/// there, and has ended when that piece reaches y, where the line is exact. A step of it that does not halve the
/// bracket is followed by one of bisection, so that no shape of the function costs more than twice the steps of
/// bisection.
enum class Inversion { secant, bisection };

/// Steps after which every search has ended.
inline constexpr int whole_depth = 64;

/// Where the inverse lies: low ≤ x ≤ high, with the function's values there.
struct CdfBracket {
  double low, high;
  double at_low, at_high;
  int steps = 0;  ///< done

  /// The inverse, the function taken as linear within the bracket.
  double position(double y) const {
    const double rise = at_high - at_low;
    return rise > 0 ? std::clamp(low + (y - at_low) / rise * (high - low), low, high) : low;
  }
  /// The linear piece that the bracket begins in.
  int piece() const { return static_cast<int>(std::floor(low)); }
};

/// Narrows a bracket to one linear piece that reaches y, or for `depth` steps. cdf(i) is the function at a whole number
/// within the bracket. Of pieces that reach y the last counts, so that none of zero rise is hit below the upper end.
template <class Cdf>
CdfBracket invert_cdf(const Cdf& cdf, CdfBracket bracket, double y, Inversion inversion, int depth = whole_depth) {
  const auto narrow = [&](double at) {
    const double value = cdf(static_cast<int>(at));
    (value <= y ? bracket.low : bracket.high) = at;
    (value <= y ? bracket.at_low : bracket.at_high) = value;
    return value <= y;
  };
  bool halve = inversion == Inversion::bisection;
  for (; bracket.steps < depth; ++bracket.steps) {
    // Whole numbers strictly inside.
    const double first = std::floor(bracket.low) + 1, last = std::ceil(bracket.high) - 1,
                 width = bracket.high - bracket.low;
    if (first > last) break;
    if (halve) {
      narrow(std::clamp(std::round((bracket.low + bracket.high) / 2), first, last));
    } else {
      const double begin = std::floor(bracket.position(y)), end = begin + 1;
      const bool beyond = begin < first || narrow(begin);
      if (beyond && end <= last) narrow(end);
    }
    halve = inversion == Inversion::bisection || (!halve && bracket.high - bracket.low > width / 2);
  }
  return bracket;
}

}  // namespace lumifield
