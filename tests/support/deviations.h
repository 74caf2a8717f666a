#pragma once

#include <cmath>

namespace lumifield::test {

/// What a deviation of n runs may be, as a share of the true one: its square's distribution is χ²_n/n, of which chance
/// passes this once in 30,000 times on either side (Wilson, Hilferty 1931).
inline double deviation_bound(int n, int side) {
  const double spread = 2.0 / (9 * n);
  return std::pow(1 - spread + 4 * side * std::sqrt(spread), 1.5);
}

}  // namespace lumifield::test
