#pragma once

#include <optional>
#include <vector>

#include "renderer/sampling/box_distribution.h"
#include "renderer/sampling/piecewise_constant_1d.h"

namespace lumifield {

/// The distribution of a whole image as precomputed tables (Lu 2015, Eq. 6): the marginal cdf(x) over all rows, and for
/// each column the conditional cdf(y|x). Exact for the whole image.
///
/// Restricted to a box as printed (Eq. 8) each table is restricted by itself, so the density becomes
///
///     q(x, y) = marginal(x) / ∫_{x0}^{x1} marginal · column(y) / ∫_{y0}^{y1} column
///
/// which is not image/A; sample and pdf below are that pair, honest about their own density. Value type, immutable,
/// safe from any thread.
class PiecewiseConstant2D {
 public:
  explicit PiecewiseConstant2D(const SummedAreaTable& image);

  double integral() const { return marginal_.integral(); }
  const PiecewiseConstant1D& marginal() const { return marginal_; }
  const PiecewiseConstant1D& column(int i) const { return columns_[static_cast<std::size_t>(i)]; }

  /// The image's whole box.
  PixelBox whole() const;
  std::optional<PixelPoint> sample(double xi1, double xi2, const PixelBox& box, Inversion inversion = Inversion::secant,
                                   int depth = whole_depth) const;
  double pdf(double x, double y, const PixelBox& box) const;
  BoxDistribution::Unit invert(double x, double y, const PixelBox& box) const;

 private:
  int column_at(double x) const;
  PiecewiseConstant1D marginal_;
  std::vector<PiecewiseConstant1D> columns_;
};

}  // namespace lumifield
