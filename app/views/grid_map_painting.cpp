#include <QPainter>
#include <algorithm>
#include <cmath>

#include "app/views/cell_marks.h"
#include "app/views/grid_map.h"
#include "app/views/value_text.h"

namespace lumifield {

namespace {
constexpr double largest_cell = 120;

/// Inside `rect`. Filled, since stroking many is slow.
void paint_frame(QPainter& painter, const QRectF& rect, double width, const QColor& colour) {
  painter.fillRect(QRectF(rect.left(), rect.top(), rect.width(), width), colour);
  painter.fillRect(QRectF(rect.left(), rect.bottom() - width, rect.width(), width), colour);
  painter.fillRect(QRectF(rect.left(), rect.top(), width, rect.height()), colour);
  painter.fillRect(QRectF(rect.right() - width, rect.top(), width, rect.height()), colour);
}
}  // namespace

GridMap::Layout GridMap::layout_cells() const {
  const Sampling& sampling = model_.geometry()->sampling;
  const double line = fontMetrics().height();
  const double left = fontMetrics().horizontalAdvance(QStringLiteral("00")) + 10;
  const double top = line + 6, bottom = 2 * line + 6, right = 8;
  const double wide = std::max(1.0, width() - left - right), high = std::max(1.0, height() - top - bottom);
  const double spacing = sampling.spacing_mm.x() / sampling.spacing_mm.y();
  const double aspect = spacing > 0 ? std::clamp(spacing, 0.25, 4.0) : 1;
  double y = std::min({high / sampling.rows, wide / sampling.columns / aspect, largest_cell, largest_cell / aspect});
  double x = y * aspect;
  // Whole device pixels, so that gaps are even.
  const double ratio = devicePixelRatioF();
  if (std::min(x, y) >= 4) x = std::floor(x * ratio) / ratio, y = std::floor(y * ratio) / ratio;
  const double from_left = left + std::floor((wide - x * sampling.columns) / 2);
  return {{from_left, top + std::floor((high - y * sampling.rows) / 2)}, x, y, std::min(x, y) >= 5 ? 1.0 : 0.0};
}

QRectF GridMap::cell_rect(CellIndex cell) const {
  if (!model_.geometry()) return {};
  const Layout at = layout_cells();
  const int from_top = model_.geometry()->sampling.rows - 1 - cell.row;
  return {at.corner.x() + cell.column * at.x, at.corner.y() + from_top * at.y, at.x - at.gap, at.y - at.gap};
}

CellIndex GridMap::nearest_cell(const QPointF& position) const {
  const Layout at = layout_cells();
  const Sampling& sampling = model_.geometry()->sampling;
  const double column = (position.x() - at.corner.x()) / at.x, from_top = (position.y() - at.corner.y()) / at.y;
  return {sampling.rows - 1 - static_cast<int>(std::clamp(from_top, 0.0, sampling.rows - 1.0)),
          static_cast<int>(std::clamp(column, 0.0, sampling.columns - 1.0))};
}

std::optional<CellIndex> GridMap::cell_at(const QPointF& position) const {
  if (!model_.geometry() || model_.total() == 0) return std::nullopt;
  const CellIndex nearest = nearest_cell(position);
  const Layout at = layout_cells();
  return cell_rect(nearest).adjusted(0, 0, at.gap, at.gap).contains(position) ? std::optional(nearest) : std::nullopt;
}

void GridMap::paintEvent(QPaintEvent*) {
  QPainter painter(this);
  if (!model_.geometry() || model_.total() == 0) {
    painter.drawText(rect().adjusted(16, 16, -16, -16), Qt::AlignCenter | Qt::TextWordWrap,
                     tr("No luminaire yet: start a scan or open one to see its cells here"));
  } else {
    for (int k = 0; k < model_.total(); ++k) {
      const CellIndex cell = model_.geometry()->sampling.index(k);
      paint_cell(painter, cell, cell_rect(cell));
    }
    paint_axes(painter);
    paint_selection(painter);
  }
  if (hasFocus()) {
    painter.setBrush(Qt::NoBrush);
    painter.setPen(palette().color(QPalette::Highlight));
    painter.drawRect(rect().adjusted(0, 0, -1, -1));
  }
}

void GridMap::paint_cell(QPainter& painter, CellIndex cell, const QRectF& rect) const {
  const LuminaireModel::State state = model_.state(cell);
  if (!figure_) return paint_state(painter, rect, state, palette());
  if (model_.cell(cell))
    paint_value(painter, cell, rect);
  else
    paint_state(painter, rect, LuminaireModel::State::unmeasured, palette());
  paint_state_badge(painter, rect, state);
}

void GridMap::paint_value(QPainter& painter, CellIndex cell, const QRectF& rect) const {
  const double value = figures_.value(*figure_, cell);
  if (!std::isfinite(value)) return paint_hatch(painter, rect, palette());
  const QColor colour(colour_of(scale_, value));
  painter.fillRect(rect, colour);
  // Below the badge.
  const QRectF lower = rect.adjusted(1, 0.36 * rect.height(), -1, 0);
  if (lower.height() < fontMetrics().height()) return;
  const auto fits = [&](const QString& text) { return fontMetrics().horizontalAdvance(text) <= lower.width(); };
  const QString text = fits(value_text(value, 2)) ? value_text(value, 2) : value_text(value, 1);
  if (!fits(text)) return;
  painter.setPen(ink_on(colour));
  painter.drawText(lower, Qt::AlignCenter, text);
}

void GridMap::paint_selection(QPainter& painter) const {
  // Dark and light lines together, so that it shows on every colour.
  const bool roomy = layout_cells().x >= 16;
  const double dark = roomy ? 4 : 3, light = dark - 2;
  for (const CellIndex cell : selection_.selected()) {
    const QRectF rect = cell_rect(cell).adjusted(-1, -1, 1, 1);
    paint_frame(painter, rect, dark, palette().color(QPalette::WindowText));
    paint_frame(painter, rect.adjusted(1, 1, -1, -1), light, palette().color(QPalette::Window));
  }
  if (const std::optional<CellIndex>& current = selection_.current()) {
    const double inset = roomy ? 4 : 1;
    const QRectF rect = cell_rect(*current).adjusted(inset, inset, -inset, -inset);
    painter.setBrush(Qt::NoBrush);
    painter.setPen(QPen(palette().color(QPalette::WindowText), 2));
    painter.drawRect(rect);
    painter.setPen(QPen(palette().color(QPalette::Window), 2, Qt::DotLine, Qt::FlatCap));
    painter.drawRect(rect);
  }
  if (band_.isNull()) return;
  QColor fill = palette().color(QPalette::Highlight);
  painter.setPen(fill);
  fill.setAlpha(50);
  painter.setBrush(fill);
  painter.drawRect(band_);
}

void GridMap::paint_axes(QPainter& painter) const {
  const Sampling& sampling = model_.geometry()->sampling;
  const Layout at = layout_cells();
  const double line = fontMetrics().height(), bottom = at.corner.y() + sampling.rows * at.y;
  painter.setPen(palette().color(QPalette::WindowText));
  painter.setBrush(Qt::NoBrush);
  const auto every = [](double room, double pitch) { return std::max(1, static_cast<int>(std::ceil(room / pitch))); };
  const int columns = every(fontMetrics().horizontalAdvance(QStringLiteral("00")) + 6, at.x), rows = every(line, at.y);
  for (int column = 0; column < sampling.columns; column += columns)
    painter.drawText(QRectF(at.corner.x() + (column + 0.5) * at.x - 20, bottom + 1, 40, line), Qt::AlignCenter,
                     QString::number(column));
  for (int row = 0; row < sampling.rows; row += rows)
    painter.drawText(QRectF(0, bottom - (row + 0.5) * at.y - line / 2, at.corner.x() - 4, line),
                     Qt::AlignRight | Qt::AlignVCenter, QString::number(row));
  painter.drawText(QRectF(0, bottom + line + 2, width(), line + 2), Qt::AlignCenter, tr("column, +x →"));
  painter.drawText(QRectF(std::max(4.0, at.corner.x() - 20), at.corner.y() - line - 5, width(), line + 2),
                   Qt::AlignLeft | Qt::AlignVCenter, tr("↑ +y, row"));
}

}  // namespace lumifield
