#include "app/views/level_mark.h"

#include <QPainter>
#include <QPainterPath>
#include <QPalette>
#include <cmath>
#include <numbers>

#include "app/views/signal_colours.h"

namespace lumifield {

namespace {

QPolygonF octagon() {
  QPolygonF corners;
  for (int k = 0; k < 8; ++k) {
    const double angle = (k + 0.5) * std::numbers::pi / 4;
    corners << QPointF(0.5 + 0.5 * std::cos(angle), 0.5 + 0.5 * std::sin(angle));
  }
  return corners;
}

/// In the unit square.
QPainterPath outline(OperatorNotice::Level level) {
  QPainterPath path;
  if (level == OperatorNotice::Level::information) path.addEllipse(QRectF(0.02, 0.02, 0.96, 0.96));
  if (level == OperatorNotice::Level::warning)
    path.addPolygon(QPolygonF() << QPointF(0.5, 0.02) << QPointF(1, 0.95) << QPointF(0, 0.95));
  if (level == OperatorNotice::Level::fault) path.addPolygon(octagon());
  path.closeSubpath();
  return path;
}

QColor colour(OperatorNotice::Level level, const QPalette& palette) {
  if (level == OperatorNotice::Level::fault) return fault_colour(palette);
  return level == OperatorNotice::Level::warning ? warning_colour(palette) : information_colour(palette);
}

void paint_sign(QPainter& painter, OperatorNotice::Level level) {
  if (level == OperatorNotice::Level::fault) {
    painter.drawLine(QPointF(0.32, 0.32), QPointF(0.68, 0.68));
    painter.drawLine(QPointF(0.32, 0.68), QPointF(0.68, 0.32));
  } else if (level == OperatorNotice::Level::warning) {
    painter.drawLine(QPointF(0.5, 0.36), QPointF(0.5, 0.62));
    painter.drawPoint(QPointF(0.5, 0.8));
  } else {
    painter.drawLine(QPointF(0.5, 0.46), QPointF(0.5, 0.74));
    painter.drawPoint(QPointF(0.5, 0.25));
  }
}

}  // namespace

void paint_level_mark(QPainter& painter, const QRectF& square, OperatorNotice::Level level, const QPalette& palette) {
  painter.save();
  painter.setRenderHint(QPainter::Antialiasing);
  painter.translate(square.topLeft());
  painter.scale(square.width(), square.height());
  painter.fillPath(outline(level), colour(level, palette));
  painter.setPen(QPen(palette.color(QPalette::Base), 0.11, Qt::SolidLine, Qt::RoundCap));
  paint_sign(painter, level);
  painter.restore();
}

}  // namespace lumifield
