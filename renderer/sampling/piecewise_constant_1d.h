#pragma once

#include <optional>
#include <span>
#include <vector>

#include "renderer/sampling/cdf_inversion.h"

namespace lumifield {

/// The distribution of a non-negative function that is constant on [i, i+1), i = 0 … n−1, and its restriction to an
/// interval, whose cdf is an affine image of its own (Lu 2015, Eq. 8):
///
///     cdf(x | [a, b]) = (F(x) − F(a)) / (F(b) − F(a)),   F(x) = ∫_0^x f
///
/// Value type, immutable, safe from any thread.
class PiecewiseConstant1D {
 public:
  PiecewiseConstant1D() = default;
  /// f: finite, not negative.
  explicit PiecewiseConstant1D(std::span<const double> f);

  int pieces() const { return static_cast<int>(f_.size()); }
  double operator()(double x) const;  ///< f, 0 outside
  double integral(double a, double b) const { return cumulative(b) - cumulative(a); }
  double integral() const { return cumulative_.back(); }
  /// F(x), constant outside.
  double cumulative(double x) const;

  /// Density over x on [a, b]; 0 where f has nothing there.
  double pdf(double x, double a, double b) const;
  /// Of xi in [0, 1); empty where f has nothing on [a, b].
  std::optional<double> sample(double xi, double a, double b, Inversion inversion = Inversion::secant,
                               int depth = whole_depth) const;
  /// The inverse of sample: cdf(x | [a, b]); 0 where f has nothing there.
  double invert(double x, double a, double b) const;

 private:
  std::vector<double> f_, cumulative_{0.0};
};

}  // namespace lumifield
