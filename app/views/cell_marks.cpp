#include "app/views/cell_marks.h"

#include <QCoreApplication>
#include <QPainter>
#include <QPalette>
#include <algorithm>
#include <cmath>

namespace lumifield {

namespace {

using State = LuminaireModel::State;

QString tr(const char* text) { return QCoreApplication::translate("CellMarks", text); }

/// Readable on light and on dark, and of different lightness.
QColor state_colour(State state) {
  switch (state) {
    case State::measuring:
      return {22, 128, 84};
    case State::waiting:
      return {120, 80, 170};
    case State::measured:
      return {92, 134, 176};
    case State::warned:
      return {240, 170, 40};
    case State::damaged:
      return {176, 40, 40};
    case State::unmeasured:
      break;
  }
  return Qt::transparent;
}

void paint_triangle(QPainter& painter, const QRectF& box, const QColor& ink) {
  painter.setPen(Qt::NoPen);
  painter.setBrush(ink);
  painter.drawPolygon(QPolygonF{{box.left() + 0.15 * box.width(), box.top()},
                                {box.right(), box.center().y()},
                                {box.left() + 0.15 * box.width(), box.bottom()}});
}

void paint_turning_arrow(QPainter& painter, const QRectF& box, const QColor& ink) {
  const double width = std::max(1.2, box.width() / 7), head = box.width() * 0.28;
  const QRectF ring = box.adjusted(width, width, -width, -width);
  painter.setBrush(Qt::NoBrush);
  painter.setPen(QPen(ink, width, Qt::SolidLine, Qt::FlatCap));
  painter.drawArc(ring, 70 * 16, 290 * 16);  // open at the upper right
  const QPointF tip(ring.right(), ring.center().y());
  painter.setPen(Qt::NoPen);
  painter.setBrush(ink);
  painter.drawPolygon(
      QPolygonF{tip + QPointF(-head, 0.1 * head), tip + QPointF(head, 0.1 * head), tip - QPointF(0, 1.3 * head)});
}

void paint_exclamation(QPainter& painter, const QRectF& box, const QColor& ink) {
  const double width = std::max(1.5, 0.22 * box.width()), x = box.center().x() - width / 2;
  painter.setPen(Qt::NoPen);
  painter.setBrush(ink);
  painter.drawRect(QRectF(x, box.top(), width, 0.62 * box.height()));
  painter.drawRect(QRectF(x, box.bottom() - 0.22 * box.height(), width, 0.22 * box.height()));
}

void paint_cross(QPainter& painter, const QRectF& box, const QColor& ink) {
  painter.setPen(QPen(ink, std::max(1.5, 0.18 * box.width()), Qt::SolidLine, Qt::FlatCap));
  painter.drawLine(box.topLeft(), box.bottomRight());
  painter.drawLine(box.topRight(), box.bottomLeft());
}

void paint_mark(QPainter& painter, const QRectF& rect, State state, double share) {
  const double side = std::max(4.0, share * std::min(rect.width(), rect.height()));
  QRectF box(0, 0, side, side);
  box.moveCenter(rect.center());
  const QColor ink = ink_on(state_colour(state));
  painter.save();
  painter.setRenderHint(QPainter::Antialiasing);
  if (state == State::measuring) paint_triangle(painter, box, ink);
  if (state == State::waiting) paint_turning_arrow(painter, box, ink);
  if (state == State::warned) paint_exclamation(painter, box, ink);
  if (state == State::damaged) paint_cross(painter, box, ink);
  painter.restore();
}

}  // namespace

QColor ink_on(const QColor& colour) {
  const double light = 0.299 * colour.red() + 0.587 * colour.green() + 0.114 * colour.blue();
  return light > 140 ? QColor(Qt::black) : QColor(Qt::white);
}

QString state_name(State state) {
  switch (state) {
    case State::unmeasured:
      return tr("unmeasured");
    case State::measuring:
      return tr("measuring now");
    case State::waiting:
      return tr("waiting for retake");
    case State::measured:
      return tr("measured");
    case State::warned:
      return tr("measured, warned");
    case State::damaged:
      return tr("damaged");
  }
  return {};
}

void paint_state(QPainter& painter, const QRectF& rect, State state, const QPalette& palette) {
  if (state == State::unmeasured) {
    painter.setBrush(Qt::NoBrush);
    painter.setPen(QPen(palette.color(QPalette::PlaceholderText), 0));
    const double line = 1 / painter.device()->devicePixelRatioF();
    return painter.drawRect(rect.adjusted(0, 0, -line, -line));
  }
  painter.fillRect(rect, state_colour(state));
  const double least = std::min(rect.width(), rect.height());
  paint_mark(painter, rect, state, least > 40 ? 0.4 : 0.62);
}

void paint_state_badge(QPainter& painter, const QRectF& rect, State state) {
  if (state == State::unmeasured || state == State::measured) return;
  const double side = std::clamp(0.45 * std::min(rect.width(), rect.height()), 5.0, 16.0);
  const QRectF badge(rect.right() - side, rect.top(), side, side);
  painter.fillRect(badge, state_colour(state));
  paint_mark(painter, badge, state, 0.74);
}

void paint_hatch(QPainter& painter, const QRectF& rect, const QPalette& palette) {
  const double w = rect.width(), h = rect.height();
  painter.setPen(QPen(palette.color(QPalette::WindowText), 0));
  painter.setBrush(Qt::NoBrush);
  const double line = 1 / painter.device()->devicePixelRatioF();
  painter.drawRect(rect.adjusted(0, 0, -line, -line));
  for (double c = 4; c < w + h; c += 5)
    painter.drawLine(rect.topLeft() + QPointF(std::max(0.0, c - h), std::min(c, h)),
                     rect.topLeft() + QPointF(std::min(c, w), std::max(0.0, c - w)));
}

}  // namespace lumifield
