#pragma once

#include <functional>
#include <span>
#include <string>

namespace lumifield {

/// Pearson's test of counts against expectations. Bins that expect fewer than 5 are pooled; nothing counted in one bin
/// says nothing, so it is not plausible.
struct ChiSquare {
  double statistic = 0;
  int degrees = 0;
  /// What the statistic passes once in 30,000 times by chance (Wilson, Hilferty 1931).
  double bound() const;
  bool plausible() const { return degrees > 0 && statistic <= bound(); }
  std::string text() const;
};
ChiSquare chi_square(std::span<const double> counts, std::span<const double> expected);

/// Draws `samples` points of the unit square (seeded), bins them over columns × rows of a rectangle, and tests them
/// against ∫ pdf over each bin, integrated by `refine`² midpoints: exact where the pdf is constant on them. A point
/// that is not drawn is missed.
struct ChiSquareGrid {
  double x0, x1, y0, y1;
  int columns, rows, refine = 1;
};
ChiSquare chi_square_2d(const ChiSquareGrid& grid, int samples, unsigned seed,
                        const std::function<bool(double xi1, double xi2, double& x, double& y)>& sample,
                        const std::function<double(double x, double y)>& pdf);

}  // namespace lumifield
