#include "acquisition/scan/frame_signal.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace lumifield {

double share_from(const RawImage& frame, double dn) {
  const auto count = std::count_if(frame.dn.begin(), frame.dn.end(), [&](auto value) { return value >= dn; });
  return static_cast<double>(count) / static_cast<double>(frame.dn.size());
}

FrameSignal mean_difference(const RawImage& lit, const RawImage& dark) {
  assert(lit.dn.size() == dark.dn.size());
  double sum = 0, squares = 0;
  for (std::size_t p = 0; p < lit.dn.size(); ++p) {
    const double d = static_cast<double>(lit.dn[p]) - static_cast<double>(dark.dn[p]);
    sum += d;
    squares += d * d;
  }
  const auto n = static_cast<double>(lit.dn.size());
  const double mean = sum / n;
  return {mean, std::sqrt(std::max(0.0, squares / n - mean * mean) / n)};
}

bool is_light(const FrameSignal& signal) { return signal.dn > 5 * signal.standard_error_dn; }

}  // namespace lumifield
