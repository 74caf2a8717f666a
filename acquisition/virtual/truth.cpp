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
  AxisCells(BasisKind kind, double spacing_mm, int window, double lamp_mm)
      : a(spacing_mm), count(cells_needed(lamp_mm, spacing_mm, window)), dual(kind, window) {}
  double center(int i) const { return (i - (count - 1) / 2.0) * a; }

  double a;
  int count;
  Dual dual;
};

/// Appends the surroundings of a term's edge, seen along a line towards p at height z.
void add_edge_breaks(const AxisTerm& term, double p, double z, std::vector<double>& breaks) {
  if (term.edge_width == 0) return;
  for (double k : {-30.0, -15.0, -6.0, -2.0, 2.0, 6.0, 15.0, 30.0})
    breaks.push_back(p - z * (term.edge + k * term.edge_width));
}

/// Appends where its lobe peaks and fades.
void add_lobe_breaks(const AxisTerm& term, double p, double z, std::vector<double>& breaks) {
  const double turn = 1 / z + term.bend_per_mm;
  if (std::abs(turn) < 1e-9) return;
  for (double k : {-6.0, -3.0, -1.5, 0.0, 1.5, 3.0, 6.0})
    breaks.push_back((p / z - term.slope + term.bend_per_mm * term.center_mm + k * term.sigma) / turn);
}

void sort_within(double low, double high, std::vector<double>& breaks) {
  std::erase_if(breaks, [&](double b) { return !(b > low && b < high); });
  breaks.push_back(low);
  breaks.push_back(high);
  std::sort(breaks.begin(), breaks.end());
  breaks.erase(std::unique(breaks.begin(), breaks.end()), breaks.end());
}

/// One axis of a term seen from a receiver: the integrand and the ends of its smooth pieces.
class AxisIntegrand {
 public:
  AxisIntegrand(const AxisTerm& term, const AxisCells* cells, double p, double z, const GaussRule& rule)
      : term_(term), cells_(cells), p_(p), z_(z), rule_(rule) {}

  double operator()(double u) const {
    const double m = (p_ - u) / z_;
    if (!cells_) return term_.window(u) * term_.lobe(u, m);
    const double s = u + kSeparationMm * m;
    double sum = 0;
    for (int i = 0; i < cells_->count; ++i) {
      const double phi = cells_->dual.basis()((u - cells_->center(i)) / cells_->a);
      if (phi != 0) sum += phi * coefficient(i, s);
    }
    return sum;
  }

  std::vector<double> breaks() const {
    std::vector<double> breaks;
    if (!cells_) {
      add_edge_breaks(term_, p_, z_, breaks);
      add_lobe_breaks(term_, p_, z_, breaks);
      sort_within(term_.low_mm(), term_.high_mm(), breaks);
      return breaks;
    }
    // Knots of every cell whose dual window meets the term's window; s(u) crosses the images' features between them.
    const double reach = cells_->a * cells_->dual.window() / 2,
                 support = cells_->a * cells_->dual.basis().half_support();
    double low = term_.high_mm(), high = term_.low_mm();
    for (int i = 0; i < cells_->count; ++i) {
      const double c = cells_->center(i);
      if (c + reach <= term_.low_mm() || c - reach >= term_.high_mm()) continue;
      low = std::min(low, c - support);
      high = std::max(high, c + support);
      for (const Basis::Piece& piece : cells_->dual.basis().pieces()) breaks.push_back(c + cells_->a * piece.begin);
    }
    add_image_breaks(breaks);
    sort_within(low, high, breaks);
    return breaks;
  }

 private:
  /// c_i(s), between the knots of the dual; from S a lobe is wider than they are apart.
  double coefficient(int i, double s) const {
    const double c = cells_->center(i), a = cells_->a;
    std::vector<double> breaks;
    for (int k = -cells_->dual.window(); k <= cells_->dual.window(); ++k) breaks.push_back(c + a * k / 2.0);
    const double low = std::max(breaks.front(), term_.low_mm()), high = std::min(breaks.back(), term_.high_mm());
    if (low >= high) return 0;
    add_edge_breaks(term_, s, kSeparationMm, breaks);
    sort_within(low, high, breaks);
    double sum = 0;
    for (std::size_t b = 0; b + 1 < breaks.size(); ++b)
      sum += rule_.integrate(breaks[b], breaks[b + 1], [&](double u) {
        return cells_->dual((u - c) / a) * term_.window(u) * term_.lobe(u, (s - u) / kSeparationMm);
      });
    return sum / a;
  }

  /// The images of a term are its window's shadow on S, blurred by its lobe: back on U along the lines to p.
  void add_image_breaks(std::vector<double>& breaks) const {
    const double r = 1 - kSeparationMm / z_;
    if (std::abs(r) < 1e-9) return;
    const double middle = term_.center_mm + kSeparationMm * term_.slope;
    const double shadow = term_.half_mm * std::abs(1 + kSeparationMm * term_.bend_per_mm);
    std::vector<double> s;
    for (double k : {-6.0, -4.0, -2.0, 0.0, 2.0, 4.0, 6.0})
      s.push_back(middle + k * (shadow / 2 + kSeparationMm * term_.sigma) / 2);
    if (term_.edge_width != 0)
      for (double u : {term_.low_mm(), term_.center_mm, term_.high_mm()}) s.push_back(u + kSeparationMm * term_.edge);
    for (double at : s) breaks.push_back((at - p_ * kSeparationMm / z_) / r);
  }

  const AxisTerm& term_;
  const AxisCells* cells_;
  double p_, z_;
  const GaussRule& rule_;
};

/// (∫ f du, ∫ u f du) over [low, high].
Vec2 moments(const AxisIntegrand& f, const GaussRule& rule, double low, double high) {
  Vec2 sum(0, 0);
  const double middle = (low + high) / 2, half = (high - low) / 2;
  for (std::size_t i = 0; i < rule.x.size(); ++i) {
    const double u = middle + half * rule.x[i], weighted = half * rule.w[i] * f(u);
    sum += weighted * Vec2(1, u);
  }
  return sum;
}

/// An axis' pieces with their moments.
struct AxisMoments {
  AxisMoments(const AxisIntegrand& f, const GaussRule& rule, std::vector<double> ends) : breaks(std::move(ends)) {
    for (std::size_t b = 0; b + 1 < breaks.size(); ++b) {
      pieces.push_back(moments(f, rule, breaks[b], breaks[b + 1]));
      total += pieces.back();
    }
  }
  std::vector<double> breaks;
  std::vector<Vec2> pieces;
  Vec2 total{0, 0};
};

/// ∫ f max(0, α + β u) du.
double clipped(const AxisIntegrand& f, const AxisMoments& m, const GaussRule& rule, double alpha, double beta) {
  double sum = 0;
  for (std::size_t b = 0; b < m.pieces.size(); ++b) {
    const double at_low = alpha + beta * m.breaks[b], at_high = alpha + beta * m.breaks[b + 1];
    if (at_low <= 0 && at_high <= 0) continue;
    Vec2 piece = m.pieces[b];
    if (at_low < 0) piece = moments(f, rule, -alpha / beta, m.breaks[b + 1]);
    if (at_high < 0) piece = moments(f, rule, m.breaks[b], -alpha / beta);
    sum += alpha * piece.x() + beta * piece.y();
  }
  return sum;
}

/// ∬ X Y max(0, n·(u−p)) of one term.
double term_integral(const AxisIntegrand& x, const AxisIntegrand& y, const TruthPoint& at, const GaussRule& rule) {
  const Vec3 &p = at.p_mm, &n = at.n;
  std::vector<double> x_breaks = x.breaks(), y_breaks = y.breaks();
  if (x_breaks.size() < 2 || y_breaks.size() < 2) return 0;
  const double constant = -n.dot(p);
  double lowest = constant, highest = constant;
  for (const auto& [slope, breaks] : {std::pair{n.x(), &x_breaks}, {n.y(), &y_breaks}}) {
    lowest += std::min(slope * breaks->front(), slope * breaks->back());
    highest += std::max(slope * breaks->front(), slope * breaks->back());
  }
  if (highest <= 0) return 0;

  const AxisMoments along_y(y, rule, y_breaks);
  if (lowest >= 0) {
    const AxisMoments along_x(x, rule, x_breaks);
    return constant * along_x.total.x() * along_y.total.x() + n.x() * along_x.total.y() * along_y.total.x() +
           n.y() * along_x.total.x() * along_y.total.y();
  }

  // The horizon crosses the term: the pieces of x also end where it meets an end of y's pieces.
  const double first = x_breaks.front(), last = x_breaks.back();
  if (n.x() != 0)
    for (double b : y_breaks) x_breaks.push_back(-(constant + n.y() * b) / n.x());
  sort_within(first, last, x_breaks);
  double sum = 0;
  for (std::size_t b = 0; b + 1 < x_breaks.size(); ++b)
    sum += rule.integrate(x_breaks[b], x_breaks[b + 1],
                          [&](double u) { return x(u) * clipped(y, along_y, rule, constant + n.x() * u, n.y()); });
  return sum;
}

/// E in the bands Y, R, G, B.
using Bands = Eigen::Array4d;

struct Source {
  Lamp lamp;
  std::optional<AxisCells> cells_x, cells_y;  ///< of the basis it is projected on
};

Bands irradiance(const Source& source, const TruthPoint& at, const GaussRule& rule) {
  const double z = at.p_mm.z();
  Bands sum = Bands::Zero();
  for (const LampTerm& term : source.lamp.terms) {
    const AxisIntegrand x(term.x, source.cells_x ? &*source.cells_x : nullptr, at.p_mm.x(), z, rule);
    const AxisIntegrand y(term.y, source.cells_y ? &*source.cells_y : nullptr, at.p_mm.y(), z, rule);
    Bands radiance;
    radiance << (kMonoWeights * term.radiance).sum(), term.radiance;
    sum += radiance * term_integral(x, y, at, rule);
  }
  return sum / (z * z * z);
}

}  // namespace

std::vector<TruthValue> truth(const WorldOptions& options, bool projected, std::span<const TruthPoint> points) {
  const std::optional<Lamp> lamp = make_lamp(options.lamp);
  if (!lamp) return {};
  Source source{*lamp, {}, {}};
  if (projected) {
    source.cells_x.emplace(options.basis, options.spacing_mm.x(), options.window, lamp->size_mm.x());
    source.cells_y.emplace(options.basis, options.spacing_mm.y(), options.window, lamp->size_mm.y());
  }
  std::vector<GaussRule> levels;
  for (int nodes : {6, 10, 16, 26, 42, 64}) levels.emplace_back(nodes);

  std::vector<TruthValue> values;
  for (const TruthPoint& at : points) {
    Bands value = Bands::Zero();
    if (at.p_mm.z() > 0) value = irradiance(source, at, levels[0]);
    for (std::size_t level = 1; level < levels.size() && at.p_mm.z() > 0; ++level) {
      const Bands finer = irradiance(source, at, levels[level]);
      const bool agree = (finer - value).abs().maxCoeff() <= 1e-6 * finer.abs().maxCoeff();
      value = finer;
      if (agree) break;
    }
    values.push_back({value[0], value[1], value[2], value[3]});
  }
  return values;
}

}  // namespace lumifield::virtual_bench
