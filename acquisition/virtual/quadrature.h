#pragma once

#include <cmath>
#include <vector>

namespace lumifield::virtual_bench {

/// Gauss–Legendre rule on [−1, 1], exact to degree 2n − 1. Value type.
struct GaussRule {
  explicit GaussRule(int n);
  std::vector<double> x, w;

  /// Calls f(u, weight) at the nodes of [low, high], cut into equal panels no longer than `longest`; nothing when
  /// empty.
  template <class F>
  void panels(double low, double high, double longest, F&& f) const {
    if (!(low < high)) return;
    const int count = static_cast<int>(std::ceil((high - low) / longest));
    const double half = (high - low) / (2 * count);
    for (int panel = 0; panel < count; ++panel)
      for (std::size_t i = 0; i < x.size(); ++i) f(low + half * (2 * panel + 1 + x[i]), half * w[i]);
  }
};

}  // namespace lumifield::virtual_bench
