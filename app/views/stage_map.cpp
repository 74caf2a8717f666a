#include "app/views/stage_map.h"

#include <QPainter>
#include <algorithm>
#include <cmath>

#include "app/views/signal_colours.h"

namespace lumifield {

namespace {

constexpr double margin = 6, dot_radius = 4;

QString millimetres(double value, int decimals) {
  const QString figure = QString::number(std::abs(value), 'f', decimals);
  const bool zero = figure.toDouble() == 0;
  return (value < 0 && !zero ? "−" : "") + figure;
}

}  // namespace

StageMap::StageMap(QWidget* parent) : QWidget(parent) {
  setAccessibleName("Stage");
  setSizePolicy(QSizePolicy::Preferred, QSizePolicy::Preferred);
  describe();
}

void StageMap::set_limits(const StageLimits& limits) {
  limits_ = limits;
  describe();
}

void StageMap::set_targets(std::vector<Vec2> stage_mm) {
  targets_ = std::move(stage_mm);
  update();
}

void StageMap::set_position(const std::optional<Vec2>& stage_mm) {
  if (position_ == stage_mm) return;
  position_ = stage_mm;
  describe();
}

bool StageMap::has_limits() const { return (limits_.high_mm - limits_.low_mm).minCoeff() > 0; }

bool StageMap::outside() const {
  if (!position_ || !has_limits()) return false;
  return (*position_ - limits_.low_mm).minCoeff() < 0 || (limits_.high_mm - *position_).minCoeff() < 0;
}

QString StageMap::position_text() const {
  if (!position_) return "position not known";
  const QString text = QString("x %1 mm, y %2 mm").arg(millimetres(position_->x(), 3), millimetres(position_->y(), 3));
  return outside() ? text + ", outside the limits" : text;
}

void StageMap::describe() {
  QString text = "Stage: " + position_text();
  if (has_limits())
    text += QString("\nTravel: x %1 … %2 mm, y %3 … %4 mm")
                .arg(millimetres(limits_.low_mm.x(), 1), millimetres(limits_.high_mm.x(), 1),
                     millimetres(limits_.low_mm.y(), 1), millimetres(limits_.high_mm.y(), 1));
  setToolTip(text);
  setAccessibleDescription(text);
  update();
}

/// The travel at one scale for both axes, in the middle.
QRectF StageMap::travel_rect() const {
  const Vec2 travel = limits_.high_mm - limits_.low_mm;
  const QRectF room = QRectF(rect()).adjusted(margin, margin, -margin, -margin);
  const double scale = std::min(room.width() / travel.x(), room.height() / travel.y());
  QRectF shown(0, 0, scale * travel.x(), scale * travel.y());
  shown.moveCenter(room.center());
  return shown;
}

QPointF StageMap::point_of(const Vec2& stage_mm) const {
  const QRectF shown = travel_rect();
  const Vec2 share = (stage_mm - limits_.low_mm).cwiseQuotient(limits_.high_mm - limits_.low_mm);
  return {shown.left() + share.x() * shown.width(), shown.bottom() - share.y() * shown.height()};
}

void StageMap::paintEvent(QPaintEvent*) {
  QPainter painter(this);
  painter.setRenderHint(QPainter::Antialiasing);
  painter.setPen(palette().color(QPalette::WindowText));
  if (!has_limits()) {
    painter.drawText(rect(), Qt::AlignCenter | Qt::TextWordWrap, "no limits known");
    return;
  }
  const QRectF shown = travel_rect();
  painter.setBrush(palette().color(QPalette::Base));
  painter.setPen(QPen(palette().color(QPalette::Mid), 1));
  painter.drawRect(shown);
  painter.setPen(Qt::NoPen);
  painter.setBrush(palette().color(QPalette::PlaceholderText));
  for (const Vec2& target : targets_) painter.drawEllipse(point_of(target), 1, 1);
  if (!position_) return;

  // Beyond the limits it is shown at the edge.
  QPointF at = point_of(*position_);
  at = {std::clamp(at.x(), shown.left(), shown.right()), std::clamp(at.y(), shown.top(), shown.bottom())};
  const QColor colour = outside() ? fault_colour(palette()) : information_colour(palette());
  QColor faint = colour;
  faint.setAlphaF(0.4F);
  painter.setPen(QPen(faint, 1));
  painter.drawLine(QPointF(shown.left(), at.y()), QPointF(shown.right(), at.y()));
  painter.drawLine(QPointF(at.x(), shown.top()), QPointF(at.x(), shown.bottom()));
  painter.setPen(QPen(palette().color(QPalette::Base), 1));
  painter.setBrush(colour);
  painter.drawEllipse(at, dot_radius, dot_radius);
}

}  // namespace lumifield
