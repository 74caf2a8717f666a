#include "renderer/study/definition_quadrature.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace lumifield {

namespace {

using Real = long double;

constexpr std::array<std::array<Real, 2>, 4> gauss{
    {{-0.86113631159405257522394648889281L, 0.34785484513745385737306394922200L},
     {-0.33998104358485626480266575910324L, 0.65214515486254614262693605077800L},
     {0.33998104358485626480266575910324L, 0.65214515486254614262693605077800L},
     {0.86113631159405257522394648889281L, 0.34785484513745385737306394922200L}}};

template <class F>
Real integrate(Real a, Real b, const F& f) {
  Real sum = 0;
  for (const auto& [x, w] : gauss) sum += w * f((a + b) / 2 + (b - a) / 2 * x);
  return (b - a) / 2 * sum;
}

Real phi(BasisKind kind, Real x) {
  const Real d = std::abs(x);
  switch (kind) {
    case BasisKind::box:
      return d <= 0.5L ? 1 : 0;
    case BasisKind::tent:
      return d < 1 ? 1 - d : 0;
    case BasisKind::bell:
      return d <= 0.5L ? 1 - 2 * d * d : d < 1 ? 2 * (1 - d) * (1 - d) : 0;
    case BasisKind::bspline2:
      return d <= 0.5L ? 0.75L - d * d : d < 1.5L ? (1.5L - d) * (1.5L - d) / 2 : 0;
  }
  return 0;
}

std::vector<Real> knots(BasisKind kind) {
  switch (kind) {
    case BasisKind::box:
      return {-0.5L, 0.5L};
    case BasisKind::tent:
      return {-1, 0, 1};
    case BasisKind::bell:
      return {-1, -0.5L, 0, 0.5L, 1};
    case BasisKind::bspline2:
      return {-1.5L, -0.5L, 0.5L, 1.5L};
  }
  return {};
}

/// An interval of u on which one pixel is seen and φ is one polynomial.
struct Interval {
  Real begin, end;
  int pixel;
};

struct Axis {
  Real delta, beyond, p, u, spacing, corner, pixel;
  int pixels;
};

std::vector<Interval> intervals(const Axis& axis, BasisKind kind) {
  std::vector<Real> cuts;
  for (Real knot : knots(kind)) cuts.push_back(axis.u + knot * axis.spacing);
  const auto edge = [&](int i) { return axis.corner + i * axis.pixel; };
  std::vector<Interval> result;
  const auto add = [&](Real begin, Real end, int pixel) {
    for (std::size_t k = 0; k + 1 < cuts.size(); ++k) {
      const Real a = std::max(begin, cuts[k]), b = std::min(end, cuts[k + 1]);
      if (a < b) result.push_back({a, b, pixel});
    }
  };
  for (int i = 0; i < axis.pixels; ++i) {
    if (axis.beyond == 0) {
      if (edge(i) <= axis.p && axis.p < edge(i + 1)) add(cuts.front(), cuts.back(), i);
      continue;
    }
    const Real magnify = (axis.delta + axis.beyond) / axis.beyond;
    const Real a = axis.p + (edge(i) - axis.p) * magnify, b = axis.p + (edge(i + 1) - axis.p) * magnify;
    add(std::min(a, b), std::max(a, b), i);
  }
  return result;
}

/// ∬ f max(0, g) over a rectangle, g linear: strips between the heights at which g = 0 crosses a side, each cut by it.
template <class F, class G>
Real integrate_above(const Interval& x, const Interval& y, const F& f, const G& g) {
  const Real g00 = g(x.begin, y.begin), g10 = g(x.end, y.begin), g01 = g(x.begin, y.end), g11 = g(x.end, y.end);
  const auto [least, greatest] = std::minmax({g00, g10, g01, g11});
  if (greatest <= 0) return 0;
  const auto row = [&](Real a, Real b, Real v) { return integrate(a, b, [&](Real u) { return f(u, v); }); };
  if (least >= 0) return integrate(y.begin, y.end, [&](Real v) { return row(x.begin, x.end, v); });

  std::vector<Real> heights{y.begin, y.end};
  for (const auto& [low, high] : {std::pair{g00, g01}, {g10, g11}})
    if ((low < 0) != (high < 0)) heights.push_back(y.begin + (y.end - y.begin) * low / (low - high));
  std::sort(heights.begin(), heights.end());
  Real sum = 0;
  for (std::size_t k = 0; k + 1 < heights.size(); ++k)
    sum += integrate(heights[k], heights[k + 1], [&](Real v) {
      const Real left = g(x.begin, v), right = g(x.end, v);
      if (left <= 0 && right <= 0) return Real(0);
      if (left >= 0 && right >= 0) return row(x.begin, x.end, v);
      const Real zero = x.begin + (x.end - x.begin) * left / (left - right);
      return left > 0 ? row(x.begin, zero, v) : row(zero, x.end, v);
    });
  return sum;
}

struct Sums {
  std::vector<Real> value, magnitude;
};

void add_cell(const LuminaireGeometry& geometry, CellIndex index, const CellImage& image, const Vec3& p_mm,
              const Vec3& n, const PointFactor& factor, Sums& sums) {
  const Sampling& s = geometry.sampling;
  const Measurement& m = geometry.measurement;
  const Real delta = geometry.planes.separation_mm, beyond = Real(p_mm.z()) - delta;
  const auto axis = [&](int k, int number, int cells, int pixels) {
    const Real center = s.center_mm[k] + (number - (cells - 1) / Real(2)) * Real(s.spacing_mm[k]);
    return Axis{delta,         beyond,          p_mm[k],
                center,        s.spacing_mm[k], m.center_mm[k] - pixels * Real(m.pixel_mm[k]) / 2,
                m.pixel_mm[k], pixels};
  };
  const Axis x = axis(0, index.column, s.columns, m.width_px), y = axis(1, index.row, s.rows, m.height_px);

  const auto facing = [&](Real ux, Real uy) {
    return n.x() * (ux - x.p) + n.y() * (uy - y.p) - n.z() * Real(p_mm.z());
  };
  // Φ δ²/cos⁴θ · cosθ · n·(u−p) / |u−p|³
  const auto integrand = [&](Real ux, Real uy) {
    const Real distance = std::hypot(ux - x.p, uy - y.p, delta + beyond), cosine = (delta + beyond) / distance;
    const Real basis = phi(s.basis, (ux - x.u) / x.spacing) * phi(s.basis, (uy - y.u) / y.spacing);
    const Real by = factor ? factor(index, {static_cast<double>(ux), static_cast<double>(uy)}) : 1;
    return by * basis * delta * delta / (cosine * cosine * cosine * cosine) * cosine * facing(ux, uy) /
           (distance * distance * distance);
  };
  const auto across = intervals(x, s.basis), down = intervals(y, s.basis);
  for (const Interval& v : down)
    for (const Interval& h : across) {
      const Real weight = integrate_above(h, v, integrand, facing);
      for (std::size_t c = 0; c < sums.value.size(); ++c) {
        const Real pixel = image.at(static_cast<int>(c), h.pixel, v.pixel);
        sums.value[c] += weight * pixel;
        sums.magnitude[c] += weight * std::abs(pixel);
      }
    }
}

}  // namespace

DefinitionValue definition_quadrature(const LightField& light_field, const Vec3& p_mm, const Vec3& n,
                                      const PointFactor& factor) {
  const LuminaireGeometry& geometry = light_field.geometry();
  Sums sums{std::vector<Real>(geometry.channels.size(), 0), std::vector<Real>(geometry.channels.size(), 0)};
  if (p_mm.z() > 0)
    for (int flat = 0; flat < geometry.sampling.cells(); ++flat)
      if (const auto image = light_field.cell(geometry.sampling.index(flat)))
        add_cell(geometry, geometry.sampling.index(flat), *image, p_mm, n, factor, sums);
  return {{sums.value.begin(), sums.value.end()}, {sums.magnitude.begin(), sums.magnitude.end()}};
}

}  // namespace lumifield
