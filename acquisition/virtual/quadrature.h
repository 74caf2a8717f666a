#pragma once

#include <vector>

namespace lumifield::virtual_bench {

/// Gauss–Legendre rule on [−1, 1], exact to degree 2n − 1. Value type.
struct GaussRule {
  explicit GaussRule(int n);
  std::vector<double> x, w;

  /// ∫ f over [a, b].
  template <class F>
  double integrate(double a, double b, F&& f) const {
    const double middle = (a + b) / 2, half = (b - a) / 2;
    double sum = 0;
    for (std::size_t i = 0; i < x.size(); ++i) sum += w[i] * f(middle + half * x[i]);
    return half * sum;
  }
};

}  // namespace lumifield::virtual_bench
