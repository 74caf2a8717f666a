#pragma once

#include <optional>

#include "renderer/sampling/cdf_inversion.h"
#include "renderer/sampling/summed_area_table.h"

namespace lumifield {

/// A point on an image, in pixels, with the pixel it was drawn from.
struct PixelPoint {
  double x, y;
  int i, j;
};

/// The distribution of an image restricted to a box, of density image/A, A the integral over the box.
///
/// x is drawn from the marginal over *the box's rows alone*, M(x) = ∫∫_{x0}^{x} over rows y0 … y1, and y from the
/// restricted conditional of x's column. (As printed, Lu 2015 Eq. 8 restricts the marginal over all rows: its density
/// is not image/A wherever columns differ in their share of light inside the box; see PiecewiseConstant2D.) Value type;
/// the table outlives it. Safe from any thread.
class BoxDistribution {
 public:
  /// The box is clipped to the image.
  BoxDistribution(const SummedAreaTable& table, const PixelBox& box);

  const PixelBox& box() const { return box_; }
  double integral() const { return at_x1_ > 0 ? at_x1_ : 0; }  ///< A

  /// xi1, xi2 in [0, 1). Empty where the box has no light.
  std::optional<PixelPoint> sample(double xi1, double xi2, Inversion inversion = Inversion::secant,
                                   int depth = whole_depth) const;
  /// Density over the image, 1/pixel².
  double pdf(double x, double y) const;
  struct Unit {
    double xi1, xi2;
  };
  /// What sample takes to (x, y), a point of the box with light.
  Unit invert(double x, double y) const;

 private:
  double marginal(double x) const;                 ///< from x0 to x
  double conditional(int column, double y) const;  ///< from y0 to y

  const SummedAreaTable* table_;
  PixelBox box_;
  double at_x1_;
};

}  // namespace lumifield
