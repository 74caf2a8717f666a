#include "app/views/colour_bar.h"

#include <QPainter>
#include <algorithm>
#include <cmath>

#include "app/views/value_text.h"

namespace lumifield {

namespace {
constexpr int bar_height = 12, side = 10;
}

ColourBar::ColourBar(QWidget* parent) : QWidget(parent) {
  setSizePolicy(QSizePolicy::Expanding, QSizePolicy::Fixed);
  setAccessibleName(tr("Colour scale"));
}

QSize ColourBar::sizeHint() const { return {320, minimumSizeHint().height()}; }
QSize ColourBar::minimumSizeHint() const { return {140, bar_height + 2 * fontMetrics().height() + 8}; }

void ColourBar::set_scale(const ValueScale& scale, const QString& name, const QString& unit) {
  scale_ = scale;
  title_ = unit.isEmpty() ? name : tr("%1 / %2").arg(name, unit);
  const QString ends = tr("%1: %2 … %3 %4, %5")
                           .arg(name, value_text(scale.from), value_text(scale.to), unit,
                                scale.logarithmic ? tr("logarithmic") : tr("linear"));
  setAccessibleDescription(ends);
  setToolTip(ends + u'\n' + tr("Values beyond the ends take their colours"));
  update();
}

QRectF ColourBar::bar_rect() const {
  return {double(side), 2.0 + fontMetrics().height(), width() - 2.0 * side, double(bar_height)};
}

void ColourBar::paintEvent(QPaintEvent*) {
  QPainter painter(this);
  const QRectF bar = bar_rect();
  const double step = 1 / devicePixelRatioF();
  for (double x = 0; x < bar.width(); x += step)
    painter.fillRect(QRectF(bar.left() + x, bar.top(), step, bar.height()),
                     QColor(share_colour(x / bar.width(), scale_.grey)));
  painter.setPen(palette().color(QPalette::WindowText));
  painter.drawRect(bar);
  const QString title = fontMetrics().elidedText(title_, Qt::ElideRight, width());
  painter.drawText(QRectF(0, 0, width(), fontMetrics().height() + 1), Qt::AlignCenter, title);
  paint_ticks(painter);
}

void ColourBar::paint_ticks(QPainter& painter) const {
  const QRectF bar = bar_rect();
  const int most = std::max(2, width() / 64);
  const std::vector<double> ticks =
      scale_.logarithmic ? decade_ticks(scale_.from, scale_.to, most) : axis_ticks(scale_.from, scale_.to, most);
  double free_from = 0;
  for (const double tick : ticks) {
    const double x = bar.left() + scale_.share(tick) * bar.width();
    const QString text = value_text(tick, 6);
    const double length = fontMetrics().horizontalAdvance(text);
    const double left = std::clamp(x - length / 2, 0.0, std::max(0.0, width() - length));
    painter.drawLine(QPointF(x, bar.bottom()), QPointF(x, bar.bottom() + 3));
    if (left < free_from) continue;
    painter.drawText(QPointF(left, bar.bottom() + 4 + fontMetrics().ascent()), text);
    free_from = left + length + 6;
  }
}

}  // namespace lumifield
