#include "renderer/methods/horizon.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace lumifield {

namespace {

struct Point {
  double x, y;
};

/// A rectangle cut by one line has at most five corners.
struct Polygon {
  std::array<Point, 5> corner;
  int corners = 0;
  void add(Point p) { corner[static_cast<std::size_t>(corners++)] = p; }
  const Point& operator[](int i) const { return corner[static_cast<std::size_t>(i)]; }
};

Polygon above_horizon(const HorizonPlane& g, const BasisRectangle& r) {
  const std::array<Point, 4> corner{{{r.x0, r.y0}, {r.x1, r.y0}, {r.x1, r.y1}, {r.x0, r.y1}}};
  Polygon polygon;
  for (std::size_t i = 0; i < 4; ++i) {
    const Point &p = corner[i], &q = corner[(i + 1) % 4];
    const double gp = g(p.x, p.y), gq = g(q.x, q.y);
    if (gp >= 0) polygon.add(p);
    if ((gp < 0) != (gq < 0)) {
      const double w = gp / (gp - gq);
      polygon.add({p.x + w * (q.x - p.x), p.y + w * (q.y - p.y)});
    }
  }
  return polygon;
}

template <class F>
double triangle_integral(const F& f, const Point& a, const Point& b, const Point& c) {
  static const double root = std::sqrt(15.0);
  const double area = std::abs((b.x - a.x) * (c.y - a.y) - (c.x - a.x) * (b.y - a.y)) / 2;
  double sum = 0.225 * f((a.x + b.x + c.x) / 3, (a.y + b.y + c.y) / 3);
  for (const double sign : {-1.0, 1.0}) {
    const double near = (6 + sign * root) / 21, far = 1 - 2 * near, weight = (155 + sign * root) / 1200;
    for (const auto& [l, m, n] : {std::array{far, near, near}, {near, far, near}, {near, near, far}})
      sum += weight * f(l * a.x + m * b.x + n * c.x, l * a.y + m * b.y + n * c.y);
  }
  return area * sum;
}

}  // namespace

double lowest(const HorizonPlane& g, const BasisRectangle& r) {
  return g.k + std::min(g.x * r.x0, g.x * r.x1) + std::min(g.y * r.y0, g.y * r.y1);
}

double highest(const HorizonPlane& g, const BasisRectangle& r) {
  return g.k + std::max(g.x * r.x0, g.x * r.x1) + std::max(g.y * r.y0, g.y * r.y1);
}

double clipped_integral(const Basis& basis, const HorizonPlane& g, const BasisRectangle& rectangle) {
  double sum = 0;
  for (const Basis::Piece& px : basis.pieces())
    for (const Basis::Piece& py : basis.pieces()) {
      const BasisRectangle r{std::max(rectangle.x0, px.begin), std::min(rectangle.x1, px.end),
                             std::max(rectangle.y0, py.begin), std::min(rectangle.y1, py.end)};
      if (r.x0 >= r.x1 || r.y0 >= r.y1 || highest(g, r) <= 0) continue;
      const auto integrand = [&](double x, double y) { return px(x) * py(y) * g(x, y); };
      const Polygon polygon = above_horizon(g, r);
      for (int i = 2; i < polygon.corners; ++i)
        sum += triangle_integral(integrand, polygon[0], polygon[i - 1], polygon[i]);
    }
  return sum;
}

}  // namespace lumifield
