#include "app/views/preview_paint.h"

#include <QFontMetricsF>
#include <QImage>
#include <QPainter>
#include <QPalette>
#include <algorithm>

#include "app/views/signal_colours.h"
#include "app/views/value_text.h"
#include "renderer/false_colour.h"

namespace lumifield {
namespace {

const QColor plate_colour(0, 0, 0, 165), plate_text(255, 255, 255), plate_warning(255, 200, 90);
constexpr double margin = 6, bar_width = 14, tick_length = 4;

/// One column, the scale's end on top.
const QImage& scale_image() {
  static const QImage made = [] {
    QImage image(1, 256, QImage::Format_RGB32);
    for (int k = 0; k < 256; ++k) {
      const auto colour = false_colour(1 - k / 255.0);
      image.setPixel(0, k, qRgb(colour[0], colour[1], colour[2]));
    }
    return image;
  }();
  return made;
}

}  // namespace

void draw_scale_bar(QPainter& painter, const QRectF& area, double top, bool clipped, const QString& unit) {
  // Choose the ticks: the end has its own label, and the others keep off it.
  const QFontMetricsF metrics(painter.font());
  const double line = metrics.height(), height = std::min(area.height() - 4 * margin - line, 15 * line);
  if (height < 2 * line) return;
  const double bar_height = height - line;
  std::vector<std::pair<double, QString>> labels = {{top, (clipped ? "≥ " : "") + value_text(top)}};
  for (const double tick : axis_ticks(0, top, std::max(1, static_cast<int>(bar_height / (2 * line)))))
    if (top == 0 || (1 - tick / top) * bar_height >= line) labels.emplace_back(tick, value_text(tick));
  double label_width = 0;
  for (const auto& [value, text] : labels) label_width = std::max(label_width, metrics.horizontalAdvance(text));

  // Plate and unit.
  const double width =
      std::max(bar_width + tick_length + margin + label_width, metrics.horizontalAdvance(unit)) + 2 * margin;
  const QRectF plate(area.right() - width - margin, area.top() + margin, width, height + line + 2 * margin);
  painter.setPen(Qt::NoPen);
  painter.setBrush(plate_colour);
  painter.drawRoundedRect(plate, 3, 3);
  painter.setPen(plate_text);
  painter.drawText(QRectF(plate.left() + margin, plate.top() + margin / 2, width, line), Qt::AlignLeft, unit);

  // Bar and ticks.
  const QRectF bar(plate.left() + margin, plate.top() + margin + 1.5 * line, bar_width, bar_height);
  painter.drawImage(bar, scale_image());
  for (const auto& [value, text] : labels) {
    const double y = top > 0 ? bar.bottom() - value / top * bar.height() : bar.bottom();
    painter.drawLine(QPointF(bar.right(), y), QPointF(bar.right() + tick_length, y));
    painter.drawText(QRectF(bar.right() + tick_length + margin / 2, y - line / 2, label_width + margin, line),
                     Qt::AlignLeft | Qt::AlignVCenter, text);
  }
}

double draw_strip(QPainter& painter, const QRectF& area, const QString& warning, const QString& text) {
  const QFontMetricsF metrics(painter.font());
  const QRectF room = area.adjusted(margin, 0, -margin, 0);
  const auto height_of = [&](const QString& words) {
    return words.isEmpty() ? 0 : metrics.boundingRect(room, Qt::TextWordWrap, words).height();
  };
  const double above = height_of(warning), height = above + height_of(text) + margin;
  QRectF strip(area.left(), area.bottom() - height, area.width(), height);
  painter.fillRect(strip, plate_colour);
  strip.adjust(margin, margin / 2, -margin, 0);
  painter.setPen(plate_warning);
  painter.drawText(strip, Qt::TextWordWrap, warning);
  painter.setPen(plate_text);
  painter.drawText(strip.adjusted(0, above, 0, 0), Qt::TextWordWrap, text);
  return height;
}

void draw_placeholder(QPainter& painter, const QRectF& area, const QPalette& palette, const QString& title,
                      const QString& text, bool fault) {
  const QFont plain = painter.font();
  QFont bold = plain;
  bold.setBold(true);
  const QRectF room = area.adjusted(4 * margin, margin, -4 * margin, -margin);
  constexpr int centred = Qt::AlignHCenter | Qt::AlignTop | Qt::TextWordWrap;
  const double title_height = QFontMetricsF(bold).boundingRect(room, centred, title).height() + margin;
  const double text_height = text.isEmpty() ? 0 : QFontMetricsF(plain).boundingRect(room, centred, text).height();
  QRectF at = room;
  at.setTop(room.top() + std::max(0.0, (room.height() - title_height - text_height) / 2));
  painter.setPen(fault ? fault_colour(palette) : palette.color(QPalette::WindowText));
  painter.setFont(bold);
  painter.drawText(at, centred, title);
  painter.setPen(palette.color(QPalette::WindowText));
  painter.setFont(plain);
  painter.drawText(at.adjusted(0, title_height, 0, 0), centred, text);
}

}  // namespace lumifield
