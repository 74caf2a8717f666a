#include <algorithm>
#include <cmath>
#include <optional>

#include "acquisition/virtual/lamps.h"
#include "acquisition/virtual/quadrature.h"
#include "acquisition/virtual/slide.h"
#include "acquisition/virtual/world.h"

/// The definition E(p, n) = ∫_U L cosθ max(0, n·(u−p))/|u−p|³ du. With cosθ = z/|u−p|, z = p_z, and L cos⁴θ a sum of
/// separable terms the distances cancel,
///
///     E = 1/z³ Σ_k A_k ∬ X_k(x, (p_x−x)/z) Y_k(y, (p_y−y)/z) max(0, n·(u−p)) dx dy.
///
/// The lamp projected on the basis is a sum of terms separable in the same way, with
///
///     X̃_k(x, m) = Σ_i φ((x−x_i)/a) c_i(x + δm),   c_i(s) = 1/a ∫ Φ′((x'−x_i)/a) X_k(x', (s−x')/δ) dx'.
namespace lumifield::virtual_bench {

namespace {

/// The cells along one axis, and their dual filter.
struct AxisCells {
  double center(int i) const { return (i - (count - 1) / 2.0) * a; }

  double a;
  int count;
  Dual dual;
};

/// One axis of a term and, projected, the quadrature of its coefficients: what does not depend on the receiver.
struct AxisSource {
  AxisSource(const AxisTerm& axis, const AxisCells* grid);

  AxisTerm term;
  const AxisCells* cells;                ///< null: the lamp itself
  std::vector<std::vector<Vec2>> nodes;  ///< of each cell's c_i: x', and weight Φ′ w/a there
  std::vector<double> knots;             ///< of the duals, within the term's window
};

AxisSource::AxisSource(const AxisTerm& axis, const AxisCells* grid)
    : term(axis), cells(grid), nodes(grid ? grid->count : 0) {
  // On a panel of detail_mm six nodes leave 1e-8.
  const GaussRule rule(6);
  for (int i = 0; i < static_cast<int>(nodes.size()); ++i)
    for (int k = -grid->dual.window(); k < grid->dual.window(); ++k) {
      const double c = grid->center(i), a = grid->a;
      const double low = std::max(c + a * k / 2, term.low_mm()), high = std::min(c + a * (k + 1) / 2, term.high_mm());
      if (low < high) knots.push_back(low);
      rule.panels(low, high, term.detail_mm(), [&](double u, double weight) {
        nodes[i].emplace_back(u, weight * grid->dual((u - c) / a) * term.window(u) / a);
      });
    }
  knots.push_back(term.high_mm());
  std::sort(knots.begin(), knots.end());
  knots.erase(std::unique(knots.begin(), knots.end()), knots.end());
}

/// What a receiver at p and height z sees of it along this axis.
class AxisIntegrand {
 public:
  AxisIntegrand(const AxisSource& source, double p, double z) : source_(source), term_(source.term), p_(p), z_(z) {}

  double operator()(double u) const;
  /// Ends of its smooth pieces.
  std::vector<double> breaks() const { return source_.cells ? projected_breaks() : lamp_breaks(); }

 private:
  std::vector<double> lamp_breaks() const;
  std::vector<double> projected_breaks() const;

  const AxisSource& source_;
  const AxisTerm& term_;
  double p_, z_;
};

double AxisIntegrand::operator()(double u) const {
  const double m = (p_ - u) / z_;
  if (!source_.cells) return term_.window(u) * term_.lobe(u, m);
  const double s = u + plane_separation_mm * m;
  double sum = 0;
  for (int i = 0; i < source_.cells->count; ++i) {
    const std::vector<Vec2>& nodes = source_.nodes[i];
    const double phi =
        nodes.empty() ? 0 : source_.cells->dual.basis()((u - source_.cells->center(i)) / source_.cells->a);
    if (phi == 0) continue;
    double coefficient = 0;
    for (const Vec2& node : nodes) coefficient += node.y() * term_.lobe(node.x(), (s - node.x()) / plane_separation_mm);
    sum += phi * coefficient;
  }
  return sum;
}

std::vector<double> sorted_within(double low, double high, std::vector<double> breaks) {
  std::erase_if(breaks, [&](double b) { return !(b > low && b < high); });
  breaks.insert(breaks.end(), {low, high});
  std::sort(breaks.begin(), breaks.end());
  breaks.erase(std::unique(breaks.begin(), breaks.end()), breaks.end());
  return breaks;
}

/// The window's ends, and where along the lines to p the lobe and the edge rise and fade.
std::vector<double> AxisIntegrand::lamp_breaks() const {
  std::vector<double> breaks;
  const double turn = 1 / z_ + term_.bend_per_mm;
  for (double k : {-6.0, -3.0, -1.5, 0.0, 1.5, 3.0, 6.0})
    if (std::abs(turn) > 1e-9) breaks.push_back((p_ / z_ - term_.lobe_center(0) + k * term_.sigma) / turn);
  for (double k : {-30.0, -15.0, -6.0, -2.0, 2.0, 6.0, 15.0, 30.0})
    if (term_.edge_width != 0) breaks.push_back(p_ - z_ * (term_.edge + k * term_.edge_width));
  return sorted_within(term_.low_mm(), term_.high_mm(), breaks);
}

/// The knots of every cell that the term reaches, and where the lines to p cross the features of its images on S: the
/// window's shadow blurred by the lobe, and the duals' knots seen through the edge.
std::vector<double> AxisIntegrand::projected_breaks() const {
  std::vector<double> breaks;
  const AxisCells& cells = *source_.cells;
  double low = term_.high_mm(), high = term_.low_mm();
  for (int i = 0; i < cells.count; ++i) {
    if (source_.nodes[i].empty()) continue;
    const double c = cells.center(i), reach = cells.a * cells.dual.basis().half_support();
    low = std::min(low, c - reach);
    high = std::max(high, c + reach);
    for (const Basis::Piece& piece : cells.dual.basis().pieces()) breaks.push_back(c + cells.a * piece.begin);
  }
  const double t = plane_separation_mm / z_;
  const auto add = [&](double s) {
    if (std::abs(1 - t) > 1e-9) breaks.push_back((s - p_ * t) / (1 - t));
  };
  const double shadow = term_.half_mm * std::abs(1 + plane_separation_mm * term_.bend_per_mm);
  for (double k : {-3.0, -2.0, -1.0, 0.0, 1.0, 2.0, 3.0})
    add(term_.center_mm + plane_separation_mm * term_.slope + k * (shadow / 2 + plane_separation_mm * term_.sigma));
  if (term_.edge_width != 0)
    for (double knot : source_.knots)
      for (double k : {-5.0, 0.0, 5.0}) add(knot + plane_separation_mm * (term_.edge + k * term_.edge_width));
  return sorted_within(low, high, breaks);
}

/// (∫ f du, ∫ u f du) over [low, high].
Vec2 moments_of(const AxisIntegrand& f, const GaussRule& rule, double low, double high) {
  Vec2 sum(0, 0);
  rule.panels(low, high, high - low, [&](double u, double weight) { sum += weight * f(u) * Vec2(1, u); });
  return sum;
}

/// An axis' smooth pieces with their moments.
struct AxisPieces {
  AxisPieces(const AxisIntegrand& integrand, const GaussRule& r, const std::vector<double>& ends)
      : f(integrand), rule(r), breaks(ends) {
    for (std::size_t b = 0; b + 1 < breaks.size(); ++b)
      moments.push_back(moments_of(f, rule, breaks[b], breaks[b + 1]));
  }
  /// ∫ f max(0, α + β u) du.
  double clipped(double alpha, double beta) const;

  const AxisIntegrand& f;
  const GaussRule& rule;
  const std::vector<double>& breaks;
  std::vector<Vec2> moments;
};

double AxisPieces::clipped(double alpha, double beta) const {
  double sum = 0;
  for (std::size_t b = 0; b < moments.size(); ++b) {
    const double at_low = alpha + beta * breaks[b], at_high = alpha + beta * breaks[b + 1];
    if (at_low <= 0 && at_high <= 0) continue;
    Vec2 piece = moments[b];
    if (at_low < 0) piece = moments_of(f, rule, -alpha / beta, breaks[b + 1]);
    if (at_high < 0) piece = moments_of(f, rule, breaks[b], -alpha / beta);
    sum += alpha * piece.x() + beta * piece.y();
  }
  return sum;
}

/// ∬ X Y max(0, n·(u−p)) of one term.
double term_integral(const AxisIntegrand& x, const AxisIntegrand& y, const TruthPoint& at, const GaussRule& rule) {
  const Vec3& n = at.n;
  const double constant = -n.dot(at.p_mm);
  std::vector<double> x_breaks = x.breaks();
  const std::vector<double> y_breaks = y.breaks();
  if (x_breaks.size() < 2 || y_breaks.size() < 2) return 0;
  const double first = x_breaks.front(), last = x_breaks.back();
  const auto highest = [](double slope, double low, double high) { return std::max(slope * low, slope * high); };
  if (constant + highest(n.x(), first, last) + highest(n.y(), y_breaks.front(), y_breaks.back()) <= 0) return 0;

  // Where the horizon crosses the term, the pieces of x also end where it meets an end of y's pieces.
  if (n.x() != 0)
    for (double b : y_breaks) x_breaks.push_back(-(constant + n.y() * b) / n.x());
  x_breaks = sorted_within(first, last, x_breaks);
  const AxisPieces along_y(y, rule, y_breaks);
  double sum = 0;
  for (std::size_t b = 0; b + 1 < x_breaks.size(); ++b)
    rule.panels(x_breaks[b], x_breaks[b + 1], last - first, [&](double u, double weight) {
      const double inner = along_y.clipped(constant + n.x() * u, n.y());
      if (inner != 0) sum += weight * x(u) * inner;
    });
  return sum;
}

/// E in the bands Y, R, G, B.
using Bands = Eigen::Array4d;

struct TermSource {
  Bands radiance;
  AxisSource x, y;
};

Bands irradiance(const std::vector<TermSource>& terms, const TruthPoint& at, const GaussRule& rule) {
  const double z = at.p_mm.z();
  Bands sum = Bands::Zero();
  for (const TermSource& term : terms)
    sum += term.radiance * term_integral({term.x, at.p_mm.x(), z}, {term.y, at.p_mm.y(), z}, at, rule);
  return sum / (z * z * z);
}

}  // namespace

std::vector<TruthValue> truth(const WorldOptions& options, bool projected, std::span<const TruthPoint> points,
                              const TruthGrid& grid) {
  if (!check(options)) return {};
  const std::optional<Lamp> lamp = make_lamp(options.lamp);
  const auto cells = [&](int axis, int asked) {
    const double a = options.spacing_mm[axis];
    const int count = asked > 0 ? asked : cells_needed(lamp->size_mm[axis], a, options.window);
    return AxisCells{a, count, Dual(options.basis, options.window)};
  };
  const AxisCells cells_x = cells(0, grid.columns), cells_y = cells(1, grid.rows);
  std::vector<TermSource> terms;
  for (const LampTerm& term : lamp->terms) {
    Bands radiance;
    radiance << (mono_weights * term.radiance).sum(), term.radiance;
    terms.push_back({radiance, {term.x, projected ? &cells_x : nullptr}, {term.y, projected ? &cells_y : nullptr}});
  }
  std::vector<GaussRule> levels;
  for (int nodes : {6, 10, 16, 26, 42, 64}) levels.emplace_back(nodes);

  std::vector<TruthValue> values;
  for (const TruthPoint& at : points) {
    Bands value = Bands::Zero();
    if (at.p_mm.z() > 0) value = irradiance(terms, at, levels[0]);
    for (std::size_t level = 1; level < levels.size() && at.p_mm.z() > 0; ++level) {
      const Bands finer = irradiance(terms, at, levels[level]);
      const bool agree = (finer - value).abs().maxCoeff() <= 1e-6 * finer.abs().maxCoeff();
      value = finer;
      if (agree) break;
    }
    values.push_back({value[0], value[1], value[2], value[3]});
  }
  return values;
}

}  // namespace lumifield::virtual_bench
