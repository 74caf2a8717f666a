#include "luminaire/basis.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cassert>
#include <cmath>

namespace lumifield {

namespace {

std::vector<Basis::Piece> pieces_of(BasisKind kind) {
  switch (kind) {
    case BasisKind::box:
      return {{-0.5, 0.5, {1, 0, 0}}};
    case BasisKind::tent:
      return {{-1, 0, {1, 1, 0}}, {0, 1, {1, -1, 0}}};
    case BasisKind::bell:
      return {{-1, -0.5, {2, 4, 2}}, {-0.5, 0.5, {1, 0, -2}}, {0.5, 1, {2, -4, 2}}};
    case BasisKind::bspline2:
      return {{-1.5, -0.5, {1.125, 1.5, 0.5}}, {-0.5, 0.5, {0.75, 0, -1}}, {0.5, 1.5, {1.125, -1.5, 0.5}}};
  }
  return {};
}

/// ∫ t^k p(t) dt over [a, b] inside one piece; three Gauss points are exact to degree 5.
double gauss_moment(const Basis::Piece& piece, int k, double a, double b) {
  static const double node = std::sqrt(0.6);
  const double middle = (a + b) / 2, half = (b - a) / 2;
  double sum = 0;
  for (const auto& [x, w] : {std::pair{-node, 5.0 / 9}, {0.0, 8.0 / 9}, {node, 5.0 / 9}}) {
    const double t = middle + half * x;
    sum += w * piece(t) * std::pow(t, k);
  }
  return half * sum;
}

}  // namespace

Basis::Basis(BasisKind kind) : kind_(kind), pieces_(pieces_of(kind)) {}

std::string_view Basis::name() const { return to_string(kind_); }

double Basis::operator()(double x) const {
  for (const Piece& piece : pieces_)
    if (x >= piece.begin && x < piece.end) return piece(x);
  return 0;
}

double Basis::moment(int k, double x0, double x1) const {
  assert(k >= 0 && k <= 2);
  if (x1 < x0) return -moment(k, x1, x0);
  double sum = 0;
  for (const Piece& piece : pieces_) {
    const double a = std::max(x0, piece.begin), b = std::min(x1, piece.end);
    if (a < b) sum += gauss_moment(piece, k, a, b);
  }
  return sum;
}

std::string_view to_string(BasisKind kind) {
  switch (kind) {
    case BasisKind::box: return "box";
    case BasisKind::tent: return "tent";
    case BasisKind::bell: return "bell";
    case BasisKind::bspline2: return "bspline2";
  }
  return "";
}

std::optional<BasisKind> basis_from_string(std::string_view name) {
  for (BasisKind kind : {BasisKind::box, BasisKind::tent, BasisKind::bell, BasisKind::bspline2})
    if (name == to_string(kind)) return kind;
  return std::nullopt;
}

namespace {

/// ∫ φ(x − i) φ(x − j) dx over |x| ≤ half, knots of both split the interval.
double windowed_product(const Basis& basis, int i, int j, double half) {
  std::vector<double> knots{-half, half};
  for (const Basis::Piece& piece : basis.pieces())
    for (double shift : {i, j})
      for (double knot : {piece.begin + shift, piece.end + shift})
        if (std::abs(knot) < half) knots.push_back(knot);
  std::sort(knots.begin(), knots.end());

  static const double node = std::sqrt(0.6);
  double sum = 0;
  for (std::size_t k = 0; k + 1 < knots.size(); ++k) {
    const double middle = (knots[k] + knots[k + 1]) / 2, reach = (knots[k + 1] - knots[k]) / 2;
    for (const auto& [x, w] : {std::pair{-node, 5.0 / 9}, {0.0, 8.0 / 9}, {node, 5.0 / 9}}) {
      const double t = middle + reach * x;
      sum += w * reach * basis(t - i) * basis(t - j);
    }
  }
  return sum;
}

}  // namespace

Dual::Dual(BasisKind kind, int window) : basis_(kind), window_(window) {
  assert(window >= 2 * basis_.half_support());
  // Shifts whose support overlaps the window: |j| < half window + half support.
  const double half = window / 2.0;
  const int shifts = static_cast<int>(std::ceil(half + basis_.half_support())) - 1;
  const int n = 2 * shifts + 1;
  Eigen::MatrixXd gram(n, n);
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) gram(i, j) = windowed_product(basis_, i - shifts, j - shifts, half);
  Eigen::VectorXd unit = Eigen::VectorXd::Zero(n);
  unit(shifts) = 1;
  const Eigen::VectorXd c = gram.ldlt().solve(unit);
  coefficients_.assign(c.data(), c.data() + n);

  // Extremes lie at knots of the shifted pieces or at the vertices of their parabolas; a fine scan brackets both.
  double highest = 0, lowest = 0;
  const int steps = 4096 * window;
  for (int s = 0; s <= steps; ++s) {
    const double y = (*this)(half * (2.0 * s / steps - 1));
    highest = std::max(highest, y);
    lowest = std::min(lowest, y);
  }
  k_positive_ = std::max(highest * highest, lowest * lowest);
  k_negative_ = -highest * lowest;
}

double Dual::operator()(double x) const {
  if (std::abs(x) > window_ / 2.0) return 0;
  const int shifts = static_cast<int>(coefficients_.size() / 2);
  double sum = 0;
  for (int j = -shifts; j <= shifts; ++j) sum += coefficients_[static_cast<std::size_t>(j + shifts)] * basis_(x - j);
  return sum;
}

}  // namespace lumifield
