#include "tests/support/chi_square.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

namespace lumifield {

double ChiSquare::bound() const {
  const double n = std::max(degrees, 1), spread = 2 / (9 * n), normal = 4;
  return n * std::pow(1 - spread + normal * std::sqrt(spread), 3);
}

std::string ChiSquare::text() const {
  return "chi-square " + std::to_string(statistic) + ", bound " + std::to_string(bound()) + ", degrees " +
         std::to_string(degrees);
}

ChiSquare chi_square(std::span<const double> counts, std::span<const double> expected) {
  ChiSquare test{0, -1};
  double few_counted = 0, few_expected = 0;
  const auto take = [&](double counted, double wanted) {
    test.statistic += (counted - wanted) * (counted - wanted) / wanted;
    ++test.degrees;
  };
  for (std::size_t k = 0; k < counts.size(); ++k) {
    if (expected[k] >= 5) {
      take(counts[k], expected[k]);
      continue;
    }
    few_counted += counts[k];
    few_expected += expected[k];
  }
  // What is impossible must not happen.
  if (few_expected > 0) take(few_counted, few_expected);
  if (few_expected == 0 && few_counted > 0) test.statistic = HUGE_VAL;
  return test;
}

ChiSquare chi_square_2d(const ChiSquareGrid& grid, int samples, unsigned seed,
                        const std::function<bool(double, double, double&, double&)>& sample,
                        const std::function<double(double, double)>& pdf) {
  const int bins = grid.columns * grid.rows;
  const double width = (grid.x1 - grid.x0) / grid.columns, height = (grid.y1 - grid.y0) / grid.rows;
  std::vector<double> counts(static_cast<std::size_t>(bins), 0.0), expected(counts);
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(0, 1);
  for (int k = 0; k < samples; ++k) {
    double x = 0, y = 0;
    const double xi1 = unit(random), xi2 = unit(random);
    if (!sample(xi1, xi2, x, y)) continue;
    const int i = std::clamp(static_cast<int>((x - grid.x0) / width), 0, grid.columns - 1);
    const int j = std::clamp(static_cast<int>((y - grid.y0) / height), 0, grid.rows - 1);
    counts[static_cast<std::size_t>(j * grid.columns + i)] += 1;
  }
  for (int j = 0; j < grid.rows * grid.refine; ++j)
    for (int i = 0; i < grid.columns * grid.refine; ++i) {
      const double x = grid.x0 + (i + 0.5) * width / grid.refine, y = grid.y0 + (j + 0.5) * height / grid.refine;
      expected[static_cast<std::size_t>(j / grid.refine * grid.columns + i / grid.refine)] +=
          samples * pdf(x, y) * width * height / grid.refine / grid.refine;
    }
  return chi_square(counts, expected);
}

}  // namespace lumifield
