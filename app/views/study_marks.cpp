#include "app/views/study_marks.h"

#include <QPalette>
#include <QPolygonF>
#include <QTransform>
#include <array>
#include <cmath>
#include <numbers>

#include "app/views/signal_colours.h"

namespace lumifield {

namespace {

struct Pair {
  const char *on_light, *on_dark;
};

/// In the order of the methods. Chosen so that the least CIELAB distance of two of them, also as seen with a missing
/// kind of cones, is as large as so many colours allow.
constexpr std::array<Pair, 10> colours{{
    {"#4021a5", "#5f8bcc"},
    {"#8a1804", "#ff4201"},
    {"#745763", "#c97d58"},
    {"#3fa563", "#5dfaa8"},
    {"#cc8212", "#ffde00"},
    {"#cf60ff", "#e55688"},
    {"#660063", "#acff7e"},
    {"#8d8ec0", "#aab9d6"},
    {"#8c00ff", "#a369ff"},
    {"#1b1b1b", "#f9fffc"},
}};

/// Corners at equal angles, the first one up; with `inner` a star.
QPainterPath polygon(int corners, double radius, double inner = 0) {
  QPolygonF points;
  const int count = inner > 0 ? 2 * corners : corners;
  for (int k = 0; k < count; ++k) {
    const double angle = 2 * std::numbers::pi * k / count - std::numbers::pi / 2;
    const double r = inner > 0 && k % 2 == 1 ? inner : radius;
    points << QPointF(r * std::cos(angle), r * std::sin(angle));
  }
  QPainterPath path;
  path.addPolygon(points);
  path.closeSubpath();
  return path;
}

/// Upright; arms twice `half` wide.
QPainterPath cross(double reach, double half) {
  QPolygonF points;
  for (int quarter = 0; quarter < 4; ++quarter) {
    const QTransform turned = QTransform().rotate(90 * quarter);
    for (const QPointF& corner : {QPointF(-half, -half), QPointF(-half, -reach), QPointF(half, -reach)})
      points << turned.map(corner);
  }
  QPainterPath path;
  path.addPolygon(points);
  path.closeSubpath();
  return path;
}

}  // namespace

QColor method_colour(Method method, const QPalette& palette) {
  const auto& [on_light, on_dark] = colours.at(static_cast<std::size_t>(method));
  const QColor base = palette.color(QPalette::Base);
  return contrast(Qt::black, base) >= contrast(Qt::white, base) ? on_light : on_dark;
}

QPainterPath method_mark(Method method, double size) {
  const double r = size / 2;
  QPainterPath path;
  switch (method) {
    case Method::closed_form:
      path.addEllipse(QPointF(0, 0), r, r);
      break;
    case Method::position_dependent:
      path.addRect(-0.88 * r, -0.88 * r, 1.76 * r, 1.76 * r);
      break;
    case Method::position_dependent_printed:
      path = polygon(4, 1.2 * r);
      break;
    case Method::uniform_box:
      path = polygon(3, 1.2 * r);
      break;
    case Method::precomputed_lights:
      path = QTransform().rotate(180).map(polygon(3, 1.2 * r));
      break;
    case Method::filtered_brdf:
      path = polygon(6, 1.1 * r);
      break;
    case Method::mis:
      path = polygon(8, 1.1 * r, 0.6 * r);
      break;
    case Method::far_field:
      path = polygon(5, 1.3 * r, 0.55 * r);
      break;
    case Method::shift_invariant:
      path = cross(r, 0.36 * r);
      break;
    case Method::reference:
      path = polygon(4, 1.4 * r, 0.55 * r);
      break;
  }
  return path;
}

QPainterPath below_arrow(double size) {
  QPainterPath path;
  path.moveTo(0, -size);
  path.lineTo(0, 0);
  path.moveTo(-0.35 * size, -0.45 * size);
  path.lineTo(0, 0);
  path.lineTo(0.35 * size, -0.45 * size);
  return path;
}

}  // namespace lumifield
