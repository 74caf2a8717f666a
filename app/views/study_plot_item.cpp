#include "app/views/study_plot_item.h"

#include <QFontMetricsF>
#include <QGraphicsLayout>
#include <QGraphicsPathItem>
#include <QGraphicsScene>
#include <QGraphicsSimpleTextItem>
#include <QPen>
#include <QTextDocument>
#include <QtCharts/QChart>
#include <QtCharts/QLineSeries>
#include <QtCharts/QLogValueAxis>
#include <algorithm>
#include <array>
#include <cmath>

#include "app/views/study_marks.h"
#include "app/views/value_text.h"

namespace lumifield {

namespace {

constexpr double mark_px = 9, arrow_px = 9;

QColor mixed(const QColor& a, const QColor& b, double share_of_b) {
  const auto mix = [&](int x, int y) { return static_cast<int>(std::lround(x + share_of_b * (y - x))); };
  return {mix(a.red(), b.red()), mix(a.green(), b.green()), mix(a.blue(), b.blue())};
}

QFont small(QFont font) {
  if (font.pixelSize() > 0)
    font.setPixelSize(std::max(8, font.pixelSize() * 9 / 10));
  else
    font.setPointSizeF(0.9 * font.pointSizeF());
  return font;
}

QString tooltip_of(const StudyPoint& point) {
  return Qt::convertFromPlainText(QString("%1\nmean Lab ΔE %2\n%3 × %4 pixels\n%5")
                                      .arg(point_text(point), value_text(point.lab_delta_e))
                                      .arg(point.width_px)
                                      .arg(point.height_px)
                                      .arg(QString::fromStdString(point.device)),
                                  Qt::WhiteSpaceNormal);
}

/// Where a name of this size may stand beside a mark, the best place first.
std::array<QPointF, 9> places(const QPointF& at, const QSizeF& size) {
  const double gap = 0.8 * mark_px, w = size.width(), h = size.height();
  return {at + QPointF(gap, -h / 2),
          at + QPointF(-gap - w, -h / 2),
          at + QPointF(0.4 * gap, -h - 0.6 * gap),
          at + QPointF(-w / 2, -h - 0.8 * gap),
          at + QPointF(-w / 2, 0.8 * gap),
          at + QPointF(-gap - w, 0),
          at + QPointF(gap, 0),
          at + QPointF(-gap - w, -h),
          at + QPointF(-w, -h - 0.8 * gap)};
}

/// What the legend does not tell: the cost, and where the chart ends, the error.
QString name_of(const StudyPoint& point, bool exact) {
  const QString cost = QString::fromStdString(cost_text(point));
  if (!exact) return cost.isEmpty() ? QString::fromUtf8(to_string(point.method).data()) : cost;
  const QString error = point.rel_rmse == 0 ? QString() : value_text(100 * point.rel_rmse, 1) + " %";
  if (error.isEmpty()) return cost.isEmpty() || cost == "exact" ? "exact" : cost + ": exact";
  return cost.isEmpty() ? error : cost + ": " + error;
}

}  // namespace

QColor quiet_colour(const QPalette& palette) {
  return mixed(palette.color(QPalette::Text), palette.color(QPalette::Base), 0.3);
}

QGraphicsSimpleTextItem* add_plain_text(QGraphicsScene& scene, QGraphicsItem* parent, const QString& text,
                                        const QFont& font, const QColor& colour) {
  auto* item = new QGraphicsSimpleTextItem(text, parent);
  if (!parent) scene.addItem(item);
  item->setFont(font);
  item->setBrush(colour);
  return item;
}

QString point_text(const StudyPoint& point) {
  const QString cost = QString::fromStdString(cost_text(point));
  return QString("%1%2: relative RMSE %3 %, %4 ms")
      .arg(QString::fromUtf8(to_string(point.method).data()), cost.isEmpty() ? cost : ", " + cost,
           value_text(100 * point.rel_rmse), value_text(point.time_ms));
}

StudyPlotItem::StudyPlotItem(const StudyPlots& plots, const StudyPlot& plot, const QPalette& palette, const QFont& font,
                             QGraphicsScene& scene)
    : plots_(plots), palette_(palette), font_(font), chart_(new QChart), name_(QString::fromStdString(plot.luminaire)) {
  scene.addItem(chart_);
  chart_->legend()->hide();
  chart_->setBackgroundVisible(false);
  chart_->setMargins({});
  chart_->layout()->setContentsMargins(0, 0, 0, 0);
  add_axes();
  QFont bold = font;
  bold.setBold(true);
  title_ = add_plain_text(scene, chart_, name_, bold, palette.color(QPalette::Text));
  for (const StudySeries& series : plot.series) add_series(series);
}

void StudyPlotItem::add_axes() {
  const QColor text = palette_.color(QPalette::Text), base = palette_.color(QPalette::Base);
  for (const bool across : {true, false}) {
    auto* axis = new QLogValueAxis(chart_);
    axis->setBase(10);
    axis->setLabelFormat("%g");
    axis->setRange(across ? plots_.time_from_ms : plots_.error_from_percent,
                   across ? plots_.time_to_ms : plots_.error_to_percent);
    axis->setMinorTickCount(8);
    axis->setLabelsFont(small(font_));
    axis->setLabelsColor(text);
    axis->setTitleFont(small(font_));
    axis->setTitleBrush(quiet_colour(palette_));
    axis->setTitleText(across ? "time, ms" : "relative RMSE, %");
    axis->setLinePen(QPen(mixed(text, base, 0.4), 1));
    axis->setGridLinePen(QPen(mixed(base, text, 0.24), 1));
    axis->setMinorGridLinePen(QPen(mixed(base, text, 0.09), 1));
    chart_->addAxis(axis, across ? Qt::AlignBottom : Qt::AlignLeft);
  }
}

void StudyPlotItem::add_series(const StudySeries& series) {
  const QColor colour = method_colour(series.method, palette_);
  auto* line = new QLineSeries(chart_);
  QPen pen(colour, 2);
  if (series.method == Method::position_dependent_printed) pen.setDashPattern({3, 2});
  line->setPen(pen);
  const std::size_t first = marks_.size();
  for (const StudyPoint& point : series.line) {
    line->append(point.time_ms, 100 * point.rel_rmse);
    add_mark(point, false);
    if (marks_.size() > first + 1) segments_.emplace_back(marks_.size() - 2, marks_.size() - 1);
    const bool end = &point == &series.line.front() || &point == &series.line.back();
    if (end) add_name(name_of(point, false));
  }
  chart_->addSeries(line);
  for (QAbstractAxis* axis : chart_->axes()) line->attachAxis(axis);
  for (const StudyPoint& point : series.exact) {
    add_mark(point, true);
    add_name(name_of(point, true));
  }
}

void StudyPlotItem::add_mark(const StudyPoint& point, bool exact) {
  const QColor colour = method_colour(point.method, palette_);
  const auto make = [&](const QPainterPath& path, const QPen& pen, const QBrush& brush) {
    auto* item = new QGraphicsPathItem(path, chart_);
    item->setPen(pen);
    item->setBrush(brush);
    item->setZValue(10);
    item->setToolTip(tooltip_of(point));
    return item;
  };
  // A rim of the base keeps marks apart that overlap.
  Mark mark{make(method_mark(point.method, mark_px), QPen(palette_.color(QPalette::Base), 1), colour), nullptr,
            point.time_ms, 100 * point.rel_rmse};
  if (exact) mark.arrow = make(below_arrow(arrow_px), QPen(colour, 1.5), Qt::NoBrush);
  marks_.push_back(mark);
}

void StudyPlotItem::add_name(const QString& text) {
  auto* item = add_plain_text(*chart_->scene(), chart_, text, small(font_), quiet_colour(palette_));
  item->setZValue(11);
  names_.push_back({item, marks_.size() - 1});
}

void StudyPlotItem::lay_out(const QRectF& place) {
  const QFontMetricsF label(small(font_)), heading(title_->font());
  const double left = label.horizontalAdvance("0.001") + 2 * label.height() + 10;
  const double bottom = 2 * label.height() + 16, top = heading.height() + 6;
  area_ = QRectF(left, top, std::max(20.0, place.width() - left - 14), std::max(20.0, place.height() - top - bottom));
  chart_->setPlotArea(area_);
  chart_->setGeometry(place);
  title_->setText(heading.elidedText(name_, Qt::ElideRight, area_.width()));
  title_->setPos(area_.left(), 0);
  place_marks();
  place_names();
}

QPointF StudyPlotItem::position(const Mark& mark) const {
  const auto share = [](double value, double from, double to) { return std::log(value / from) / std::log(to / from); };
  const double x = area_.left() + area_.width() * share(mark.time_ms, plots_.time_from_ms, plots_.time_to_ms);
  if (mark.arrow) return {x, area_.bottom() - arrow_px - mark_px / 2 - 1};
  return {x, area_.bottom() -
                 area_.height() * share(mark.error_percent, plots_.error_from_percent, plots_.error_to_percent)};
}

void StudyPlotItem::place_marks() {
  for (const Mark& mark : marks_) {
    const QPointF at = position(mark);
    mark.shape->setPos(at);
    if (mark.arrow) mark.arrow->setPos(at.x(), area_.bottom());
  }
}

/// What names may not cover: marks, and lines in steps of a few pixels.
std::vector<QRectF> StudyPlotItem::taken() const {
  constexpr double step = 5;
  std::vector<QRectF> all;
  for (const Mark& mark : marks_) {
    const QPointF at = position(mark);
    all.emplace_back(at.x() - mark_px / 2, at.y() - mark_px / 2, mark_px, mark_px + (mark.arrow ? arrow_px + 1 : 0));
  }
  for (const auto& [a, b] : segments_) {
    const QPointF from = position(marks_[a]), way = position(marks_[b]) - from;
    const int steps = static_cast<int>(std::hypot(way.x(), way.y()) / step) + 1;
    for (int k = 0; k < steps; ++k) {
      const QPointF at = from + way * k / steps;
      all.emplace_back(at.x() - 1, at.y() - 1, 2, 2);
    }
  }
  return all;
}

/// Exact ones first, and higher where their places are taken: without its name such a mark would be read off the axis.
void StudyPlotItem::place_names() {
  constexpr int steps_up = 8;
  std::vector<QRectF> occupied = taken();
  const QRectF room = area_.adjusted(1, 1, 10, -1);
  const auto free = [&](const QRectF& rect) {
    return room.contains(rect) &&
           std::ranges::none_of(occupied, [&](const QRectF& other) { return other.intersects(rect); });
  };
  std::ranges::stable_partition(names_, [&](const Name& name) { return marks_[name.mark].arrow != nullptr; });
  for (const Name& name : names_) {
    const Mark& mark = marks_[name.mark];
    const QSizeF size = name.text->boundingRect().size();
    name.text->hide();
    for (int step = 0; step <= (mark.arrow ? steps_up : 0) && !name.text->isVisible(); ++step)
      for (const QPointF& place : places(position(mark) - QPointF(0, step * size.height()), size)) {
        if (!free({place, size})) continue;
        name.text->setPos(place);
        name.text->show();
        occupied.emplace_back(place, size);
        break;
      }
  }
}

}  // namespace lumifield
