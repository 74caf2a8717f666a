#pragma once

#include <array>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace lumifield {

enum class BasisKind { box, tent, bell, bspline2 };

/// A reconstruction basis φ of one variable, in units of the cell spacing: an even, compactly supported piecewise
/// polynomial of degree ≤ 2 with ∫φ = 1 whose integer shifts sum to 1. The basis of a cell on plane U is the product
/// Φ_m(u) = φ((u_x − u_mx)/a_x) · φ((u_y − u_my)/a_y), a_x and a_y being the spacing.
///
/// box and tent are the B-splines of degree 0 and 1, bspline2 that of degree 2; bell is Granier et al. 2003, Eq. 6. Each
/// reproduces polynomials up to degree 0, 1, 2 and 0 (bell) respectively. Value type, immutable, safe from any thread.
class Basis {
 public:
  /// φ(x) = c[0] + c[1] x + c[2] x² on [begin, end).
  struct Piece {
    double begin, end;
    std::array<double, 3> c;
    double operator()(double x) const { return c[0] + x * (c[1] + x * c[2]); }
  };

  explicit Basis(BasisKind kind);

  BasisKind kind() const { return kind_; }
  std::string_view name() const;
  std::span<const Piece> pieces() const { return pieces_; }
  double half_support() const { return pieces_.back().end; }
  /// Number of cells that overlap a point in general position along one axis (the support in spacings).
  int overlap() const { return static_cast<int>(2 * half_support()); }

  double operator()(double x) const;

  /// ∫ t^k φ(t) dt over [x0, x1], k = 0, 1, 2, split at the knots, Gauss rule exact on each piece: no cancellation when the
  /// interval is short, which differences of antiderivatives would have. x1 < x0 gives the negative.
  double moment(int k, double x0, double x1) const;

 private:
  BasisKind kind_;
  std::vector<Piece> pieces_;
};

std::string_view to_string(BasisKind kind);
std::optional<BasisKind> basis_from_string(std::string_view name);

/// The dual filter Φ′ of a basis: ∫ Φ′(x) φ(x − j) dx = 1 for j = 0, 0 otherwise, least norm on |x| ≤ window/2 spacings.
/// It is what a scan puts before the lamp: through it the camera sees C_m itself (Goesele et al. 2003).
///
/// Printed as two slides T⁺ = max(Φ′, 0)/k⁺ and T⁻ = max(−Φ′, 0)/k⁻ with transmissions ≤ 1; C = (k⁺E⁺ − k⁻E⁻)/(a_x a_y).
/// The 2-D dual is the product of two 1-D ones. Value type, immutable, safe from any thread.
class Dual {
 public:
  /// window: width in spacings, ≥ the basis' support. Windows with window + support even are well conditioned.
  Dual(BasisKind kind, int window);

  double operator()(double x) const;
  int window() const { return window_; }
  const Basis& basis() const { return basis_; }
  /// Coefficient of φ(x − j), j = −shifts … shifts.
  std::span<const double> coefficients() const { return coefficients_; }

  double k_positive() const { return k_positive_; }  ///< max of Φ′(x)Φ′(y), times 1/(a_x a_y)
  double k_negative() const { return k_negative_; }  ///< max of −Φ′(x)Φ′(y), times 1/(a_x a_y)

 private:
  Basis basis_;
  int window_;
  std::vector<double> coefficients_;
  double k_positive_ = 0, k_negative_ = 0;
};

}  // namespace lumifield
