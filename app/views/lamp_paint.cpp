#include "app/views/lamp_paint.h"

#include <QFontMetricsF>
#include <QPainter>
#include <QPainterPath>
#include <algorithm>
#include <numbers>

namespace lumifield {
namespace {

const QColor casing(0, 0, 0, 170), plain(235, 235, 235), chosen_colour(255, 170, 40), badge_text(20, 20, 20),
    chosen_fill(255, 170, 40, 60);
constexpr double head_px = 9, head_half_px = 4.5, ring_px = 6, casing_px = 2;

QPointF point(const Vec2& p) { return {p.x(), p.y()}; }

QPainterPath outline_of(const LampHandle& handle) {
  QPainterPath path(point(handle.outline[0]));
  for (std::size_t k = 1; k < 4; ++k) path.lineTo(point(handle.outline[k]));
  path.closeSubpath();
  return path;
}

/// Seen nearly along the arrow: its point in a ring where it comes towards the eye, else its feathers, as in drawings.
QPainterPath end_of(const LampHandle& handle) {
  const QPointF at = point(handle.centre);
  QPainterPath path;
  path.addEllipse(at, ring_px, ring_px);
  if (handle.towards_eye) {
    path.addEllipse(at, ring_px / 4, ring_px / 4);
    return path;
  }
  const double feather = ring_px * std::numbers::sqrt2 / 2;
  for (const double side : {-feather, feather}) {
    path.moveTo(at + QPointF(-feather, side));
    path.lineTo(at + QPointF(feather, -side));
  }
  return path;
}

QPainterPath head_of(const LampHandle& handle) {
  const Vec2 along = handle.tip - handle.centre;
  const Vec2 on = along.normalized(), across(-on.y(), on.x()), foot = handle.tip - head_px * on;
  QPainterPath path(point(handle.tip));
  path.lineTo(point(foot + head_half_px * across));
  path.lineTo(point(foot - head_half_px * across));
  path.closeSubpath();
  return path;
}

/// On the side of the lamp that the arrow leaves free.
void draw_number(QPainter& painter, const LampHandle& handle, const QColor& colour) {
  const QString number = QString::number(handle.lamp + 1);
  const QFontMetricsF metrics(painter.font());
  const double height = metrics.height(), width = std::max(height, metrics.horizontalAdvance(number) + height / 2);
  double low = handle.outline[0].y(), high = low;
  for (const Vec2& p : handle.outline) {
    low = std::min(low, p.y());
    high = std::max(high, p.y());
  }
  const bool below = handle.tip.y() < handle.centre.y();
  const double y = below ? high + height / 2 + casing_px : low - height / 2 - casing_px;
  const QRectF badge(handle.centre.x() - width / 2, y - height / 2, width, height);
  painter.setPen(QPen(casing, casing_px));
  painter.setBrush(colour);
  painter.drawRoundedRect(badge, height / 2, height / 2);
  painter.setPen(badge_text);
  painter.drawText(badge, Qt::AlignCenter, number);
}

void draw(QPainter& painter, const LampHandle& handle, bool body, bool tip, bool chosen) {
  const QColor colour = chosen ? chosen_colour : plain;
  const bool across = (handle.tip - handle.centre).norm() > 2 * reach_px;  // what can be hit
  QPainterPath lines = outline_of(handle);
  if (across) {
    lines.moveTo(point(handle.centre));
    lines.lineTo(point(handle.tip));
  } else {
    lines.addPath(end_of(handle));
  }
  if (chosen) painter.fillPath(outline_of(handle), chosen_fill);
  for (const bool dark : {true, false}) {
    const double more = dark ? 2 * casing_px : 0;
    const QColor ink = dark ? casing : colour;
    painter.setBrush(Qt::NoBrush);
    painter.setPen(QPen(ink, (body ? 3 : 1.5) + more, Qt::SolidLine, Qt::RoundCap, Qt::RoundJoin));
    painter.drawPath(lines);
    if (!across) continue;
    painter.setPen(QPen(ink, (tip ? 4 : 1) + more, Qt::SolidLine, Qt::RoundCap, Qt::RoundJoin));
    painter.setBrush(dark ? QBrush(Qt::NoBrush) : QBrush(colour));
    painter.drawPath(head_of(handle));
  }
  draw_number(painter, handle, colour);
}

}  // namespace

void draw_lamps(QPainter& painter, const PictureProjection& view, const std::vector<LampHandle>& handles,
                const std::optional<LampHit>& at, int chosen) {
  painter.save();
  painter.setClipRect(QRectF(point(view.corner_px()), QSizeF(view.size_px().x(), view.size_px().y())));
  painter.setRenderHint(QPainter::Antialiasing);
  // The chosen one on top.
  for (const bool last : {false, true})
    for (const LampHandle& handle : handles) {
      if ((handle.lamp == chosen) != last) continue;
      const bool here = at && at->lamp == handle.lamp;
      draw(painter, handle, here && at->part == LampPart::body, here && at->part == LampPart::tip, last);
    }
  painter.restore();
}

}  // namespace lumifield
