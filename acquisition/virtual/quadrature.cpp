#include "acquisition/virtual/quadrature.h"

#include <cmath>
#include <numbers>

namespace lumifield::virtual_bench {

GaussRule::GaussRule(int n) : x(n), w(n) {
  for (int i = 0; i < n; ++i) {
    // Newton on the Legendre polynomial P_n from Tricomi's guess.
    double t = std::cos(std::numbers::pi * (n - i - 0.25) / (n + 0.5)), slope = 1;
    for (int step = 0; step < 50; ++step) {
      double p = 1, before = 0;
      for (int k = 1; k <= n; ++k) {
        const double next = ((2 * k - 1) * t * p - (k - 1) * before) / k;
        before = p;
        p = next;
      }
      slope = n * (t * p - before) / (t * t - 1);
      t -= p / slope;
      if (std::abs(p / slope) < 1e-15) break;
    }
    x[i] = t;
    w[i] = 2 / ((1 - t * t) * slope * slope);
  }
}

}  // namespace lumifield::virtual_bench
