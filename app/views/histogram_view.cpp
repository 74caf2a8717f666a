#include "app/views/histogram_view.h"

#include <QHelpEvent>
#include <QKeyEvent>
#include <QPainter>
#include <QToolTip>
#include <algorithm>
#include <cmath>

#include "app/views/value_text.h"

namespace lumifield {

namespace {

/// Readable on light and on dark.
const QColor marker_colour(222, 64, 52), bar_colour(92, 134, 176);

QString count_text(std::uint64_t count) { return value_text(static_cast<double>(count), 15); }

}  // namespace

HistogramView::HistogramView(QWidget* parent) : QWidget(parent) {
  setFocusPolicy(Qt::StrongFocus);
  setSizePolicy(QSizePolicy::Expanding, QSizePolicy::Preferred);
  setAccessibleName(tr("Histogram"));
  describe();
}

QSize HistogramView::sizeHint() const { return {380, 120}; }
QSize HistogramView::minimumSizeHint() const { return {180, 66}; }

void HistogramView::set_histogram(Histogram histogram) {
  histogram_ = std::move(histogram);
  highest_ = histogram_.counts.empty() ? 0 : *std::ranges::max_element(histogram_.counts);
  describe();
  update();
}

void HistogramView::set_marker(std::optional<double> value, const QString& name) {
  marker_ = value;
  marker_name_ = name;
  describe();
  update();
}

void HistogramView::set_placeholder(const QString& text) {
  placeholder_ = text;
  describe();
  update();
}

void HistogramView::set_logarithmic(bool logarithmic) {
  if (logarithmic == logarithmic_) return;
  logarithmic_ = logarithmic;
  describe();
  update();
  emit logarithmicChanged(logarithmic);
}

void HistogramView::describe() {
  if (highest_ == 0) return setAccessibleDescription(placeholder_);
  const auto high = std::ranges::max_element(histogram_.counts) - histogram_.counts.begin();
  const double width = (histogram_.to - histogram_.from) / static_cast<double>(histogram_.counts.size());
  QString text = tr("Most %1 at %2 %3, counts %4; L switches linear and logarithmic counts")
                     .arg(histogram_.counted)
                     .arg(value_text(histogram_.from + (static_cast<double>(high) + 0.5) * width))
                     .arg(histogram_.unit, logarithmic_ ? tr("logarithmic") : tr("linear"));
  if (marker_) text += tr("; %1 at %2 %3").arg(marker_name_, value_text(*marker_, 5), histogram_.unit);
  setAccessibleDescription(text);
}

QRectF HistogramView::plot_rect() const {
  const QFontMetrics metrics = fontMetrics();
  const double left = metrics.horizontalAdvance(count_text(std::max<std::uint64_t>(highest_, 100))) + 8;
  const double bottom = 2 * metrics.height() + 5, top = 1.5 * metrics.height() + 2;
  return QRectF(rect()).adjusted(left, top, -10, -bottom);
}

double HistogramView::height_share(std::uint64_t count) const {
  if (count == 0 || highest_ == 0) return 0;
  const auto c = static_cast<double>(count), most = static_cast<double>(highest_);
  // A single one is seen on the logarithmic scale: it starts below 1.
  return logarithmic_ ? (std::log10(c) + 0.3) / (std::log10(most) + 0.3) : c / most;
}

double HistogramView::x_of(double value) const {
  const QRectF plot = plot_rect();
  return plot.left() + plot.width() * (value - histogram_.from) / (histogram_.to - histogram_.from);
}

QString HistogramView::text_at(const QPointF& position) const {
  const QRectF plot = plot_rect();
  const auto bins = static_cast<double>(histogram_.counts.size());
  const double bin = std::floor((position.x() - plot.left()) / plot.width() * bins);
  if (highest_ == 0 || !(bin >= 0) || bin >= bins) return {};
  const double width = (histogram_.to - histogram_.from) / bins;
  return tr("%1 … %2 %3: %4 %5")
      .arg(value_text(histogram_.from + bin * width, 4), value_text(histogram_.from + (bin + 1) * width, 4),
           histogram_.unit, count_text(histogram_.counts[static_cast<std::size_t>(bin)]), histogram_.counted);
}

bool HistogramView::event(QEvent* event) {
  if (event->type() != QEvent::ToolTip) return QWidget::event(event);
  const auto* help = static_cast<QHelpEvent*>(event);
  const QString bin = text_at(help->pos());
  QToolTip::showText(help->globalPos(), (bin.isEmpty() ? QString() : bin + u'\n') + toolTip(), this);
  return true;
}

void HistogramView::keyPressEvent(QKeyEvent* event) {
  if (event->key() == Qt::Key_L && event->modifiers() == Qt::NoModifier) return set_logarithmic(!logarithmic_);
  QWidget::keyPressEvent(event);
}

void HistogramView::paintEvent(QPaintEvent*) {
  QPainter painter(this);
  if (highest_ == 0) {
    painter.drawText(rect().adjusted(8, 8, -8, -8), Qt::AlignCenter | Qt::TextWordWrap, placeholder_);
  } else {
    painter.fillRect(plot_rect(), palette().color(QPalette::Base));
    if (marker_ && *marker_ >= histogram_.from && *marker_ <= histogram_.to) paint_marker(painter);
    paint_bars(painter);  // over the marker: the bin at saturation shows
    paint_value_axis(painter);
    paint_count_axis(painter);
  }
  if (hasFocus()) {
    painter.setPen(palette().color(QPalette::Highlight));
    painter.drawRect(rect().adjusted(0, 0, -1, -1));
  }
}

void HistogramView::paint_bars(QPainter& painter) const {
  const QRectF plot = plot_rect();
  const double step = 1 / devicePixelRatioF();  // bars are two wide, so that a lone one is seen
  const auto bins = static_cast<double>(histogram_.counts.size());
  const auto last = static_cast<std::ptrdiff_t>(histogram_.counts.size()) - 1;
  for (double x = 0; x < plot.width(); x += step) {
    const auto first_bin = std::min(last, static_cast<std::ptrdiff_t>(x / plot.width() * bins));
    const auto end_bin = static_cast<std::ptrdiff_t>(std::ceil((x + step) / plot.width() * bins - 1e-9));
    const auto begin = histogram_.counts.begin() + first_bin;
    const auto end = histogram_.counts.begin() + std::clamp(end_bin, first_bin + 1, last + 1);
    const double share = height_share(*std::max_element(begin, end));
    if (share <= 0) continue;
    const double height = std::max(share * plot.height(), 2 * step);
    painter.fillRect(QRectF(plot.left() + x, plot.bottom() - height, 2, height), bar_colour);
  }
}

void HistogramView::paint_value_axis(QPainter& painter) const {
  const QRectF plot = plot_rect();
  const QFontMetrics metrics = fontMetrics();
  painter.setPen(palette().color(QPalette::WindowText));
  painter.drawLine(plot.bottomLeft(), plot.bottomRight());
  double free_from = 0;
  for (const double tick :
       axis_ticks(histogram_.from, histogram_.to, std::max(2, static_cast<int>(plot.width() / 70)))) {
    const double x = x_of(tick);
    painter.drawLine(QPointF(x, plot.bottom()), QPointF(x, plot.bottom() + 3));
    const QString text = value_text(tick, 6);
    const double width = metrics.horizontalAdvance(text);
    const double left = std::clamp(x - width / 2, 0.0, this->width() - width);
    if (left < free_from) continue;
    painter.drawText(QPointF(left, plot.bottom() + 3 + metrics.ascent()), text);
    free_from = left + width + 6;
  }
  const QString name =
      histogram_.unit.isEmpty() ? histogram_.axis : tr("%1 / %2").arg(histogram_.axis, histogram_.unit);
  painter.drawText(QRectF(plot.left(), plot.bottom() + 3 + metrics.height(), plot.width(), metrics.height()),
                   Qt::AlignCenter, metrics.elidedText(name, Qt::ElideRight, static_cast<int>(plot.width())));
}

void HistogramView::paint_count_axis(QPainter& painter) const {
  const QRectF plot = plot_rect();
  const QFontMetrics metrics = fontMetrics();
  const auto label = [&](std::uint64_t count, double share) {
    const double y = plot.bottom() - share * plot.height();
    painter.drawLine(QPointF(plot.left() - 3, y), QPointF(plot.left(), y));
    painter.drawText(QRectF(0, y - metrics.height() / 2.0, plot.left() - 5, metrics.height()),
                     Qt::AlignRight | Qt::AlignVCenter, count_text(count));
  };
  painter.setPen(palette().color(QPalette::WindowText));
  label(highest_, 1);
  if (!logarithmic_) label(0, 0);
  double lowest_free = plot.top() + metrics.height();
  for (std::uint64_t decade = highest_ / 10; logarithmic_ && decade >= 1; decade /= 10) {
    const auto round =
        static_cast<std::uint64_t>(std::pow(10, std::floor(std::log10(static_cast<double>(decade)) + 1e-9)));
    const double y = plot.bottom() - height_share(round) * plot.height();
    if (y < lowest_free) continue;
    label(round, height_share(round));
    lowest_free = y + metrics.height();
  }
  painter.drawText(QRectF(2, 0, width() / 2.0, metrics.height() + 1), Qt::AlignLeft | Qt::AlignVCenter,
                   logarithmic_ ? tr("%1, logarithmic").arg(histogram_.counted) : histogram_.counted);
}

void HistogramView::paint_marker(QPainter& painter) const {
  const QRectF plot = plot_rect();
  const double x = x_of(*marker_), width = fontMetrics().horizontalAdvance(marker_name_);
  painter.setPen(QPen(marker_colour, 2, Qt::DashLine));
  painter.drawLine(QPointF(x, plot.top() - 2), QPointF(x, plot.bottom()));
  painter.setPen(palette().color(QPalette::WindowText));
  const double left =
      std::clamp(x - width - 4, this->width() / 2.0, std::max(this->width() / 2.0, this->width() - width - 2));
  painter.drawText(QRectF(left, 0, width + 2, fontMetrics().height() + 1), Qt::AlignVCenter, marker_name_);
}

}  // namespace lumifield
