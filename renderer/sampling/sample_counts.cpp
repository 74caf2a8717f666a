#include "renderer/sampling/sample_counts.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace lumifield {

std::vector<double> expected_counts(std::span<const double> a, double k, double k_max) {
  const double all = std::accumulate(a.begin(), a.end(), 0.0);
  std::vector<double> kappa(a.size(), 0.0);
  if (!(all > 0)) return kappa;
  for (std::size_t m = 0; m < a.size(); ++m) {
    kappa[m] = k * (a[m] / all);
    if (k_max > 0) kappa[m] = std::min(kappa[m], k_max);
  }
  return kappa;
}

std::vector<int> systematic_rounding(std::span<const double> kappa, double offset) {
  std::vector<int> counts;
  counts.reserve(kappa.size());
  double sum = offset;
  for (const double each : kappa) {
    const double before = std::floor(sum);
    sum += each;
    counts.push_back(static_cast<int>(std::floor(sum) - before));
  }
  return counts;
}

std::vector<int> nearest_counts(std::span<const double> kappa) {
  std::vector<int> counts;
  for (const double each : kappa) counts.push_back(static_cast<int>(std::floor(each + 0.5)));
  return counts;
}

}  // namespace lumifield
