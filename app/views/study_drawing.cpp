#include "app/views/study_drawing.h"

#include <QDir>
#include <QFileInfo>
#include <QFontMetricsF>
#include <QGraphicsPathItem>
#include <QGraphicsSimpleTextItem>
#include <QGraphicsTextItem>
#include <QStringList>
#include <algorithm>
#include <cmath>
#include <set>

#include "app/views/study_marks.h"
#include "app/views/value_text.h"

namespace lumifield {

namespace {

constexpr double margin = 10, least_plot_width = 300, least_plot_height = 230, sample_px = 26;

/// A scene's name, or of its file the part that tells it from others.
QString scene_name(const QString& scene) {
  const QFileInfo info(scene);
  if (info.suffix() != "json") return scene;
  return info.completeBaseName() == "scene" ? info.dir().dirName() : info.completeBaseName();
}

QString title_of(const Study& study) {
  const QString scene = scene_name(QString::fromStdString(study.scene));
  return QString("Error against time%1%2").arg(scene.isEmpty() ? "" : ": " + scene, study.quick ? ", quick study" : "");
}

bool has_exact(const StudyPlots& plots) {
  return std::ranges::any_of(plots.plots, [](const StudyPlot& plot) {
    return std::ranges::any_of(plot.series, [](const StudySeries& series) { return !series.exact.empty(); });
  });
}

QString devices_of(const StudyPlots& plots) {
  std::set<QString> devices;
  for (const StudyPlot& plot : plots.plots)
    for (const StudySeries& series : plot.series) devices.insert(QString::fromStdString(series.device));
  return QStringList(devices.begin(), devices.end()).join("; ");
}

QString caption_of(const StudyPlots& plots) {
  QStringList parts;
  if (plots.width_px > 0)
    parts << QString("Time: kernels of one picture of %1 × %2 pixels on %3.")
                 .arg(plots.width_px)
                 .arg(plots.height_px)
                 .arg(devices_of(plots));
  if (has_exact(plots)) parts << QString("↓ at the lower edge: error below %1 %.").arg(least_error_percent);
  if (plots.other_size > 0) parts << QString("Not drawn: %1 at another picture size.").arg(plots.other_size);
  if (plots.not_finite > 0) parts << QString("Not drawn: %1 without a time or an error.").arg(plots.not_finite);
  if (plots.out_of_range > 0)
    parts << QString("Not drawn: %1 outside %2 to %3 ms or above %4 %.")
                 .arg(plots.out_of_range)
                 .arg(value_text(least_time_ms), value_text(largest_time_ms), value_text(largest_error_percent));
  return parts.join(" ");
}

}  // namespace

StudyDrawing::StudyDrawing(const Study& study, const QPalette& palette, const QFont& font, QObject* parent)
    : QGraphicsScene(parent), plots_(plots_of(study)), palette_(palette), font_(font) {
  setBackgroundBrush(palette.color(QPalette::Base));
  QFont large = font;
  large.setBold(true);
  title_ = add_paragraph(title_of(study), large, palette.color(QPalette::Text));
  for (const StudyPlot& plot : plots_.plots)
    items_.push_back(std::make_unique<StudyPlotItem>(plots_, plot, palette, font, *this));
  add_legend();
  caption_ = add_paragraph(caption_of(plots_), font, quiet_colour(palette));
}

QGraphicsTextItem* StudyDrawing::add_paragraph(const QString& text, const QFont& font, const QColor& colour) {
  auto* item = addText({}, font);
  item->setPlainText(text);
  item->setDefaultTextColor(colour);
  return item;
}

void StudyDrawing::add_legend() {
  std::set<Method> present;
  for (const StudyPlot& plot : plots_.plots)
    for (const StudySeries& series : plot.series) present.insert(series.method);
  for (const Method method : present) {
    const QColor colour = method_colour(method, palette_);
    auto* line = addLine(-sample_px / 2, 0, sample_px / 2, 0);
    QPen pen(colour, 2);
    if (method == Method::position_dependent_printed) pen.setDashPattern({3, 2});
    line->setPen(pen);
    auto* mark = new QGraphicsPathItem(method_mark(method, 9), line);
    mark->setPen(QPen(palette_.color(QPalette::Base), 1));
    mark->setBrush(colour);
    auto* name = add_plain_text(*this, nullptr, QString::fromUtf8(to_string(method).data()), font_,
                                palette_.color(QPalette::Text));
    const QString what = QString::fromUtf8(info(method).what.data());
    for (QGraphicsItem* part :
         {static_cast<QGraphicsItem*>(line), static_cast<QGraphicsItem*>(mark), static_cast<QGraphicsItem*>(name)})
      part->setToolTip(what);
    legend_.push_back({line, name});
  }
}

double StudyDrawing::lay_out_legend(double width, double top) {
  constexpr double gap = 6, between = 18;
  const double line_height = QFontMetricsF(font_).height() + 4;
  double x = margin, y = top;
  for (const LegendEntry& entry : legend_) {
    const double wide = sample_px + gap + entry.name->boundingRect().width();
    if (x > margin && x + wide > width - margin) {
      x = margin;
      y += line_height;
    }
    entry.mark->setPos(x + sample_px / 2, y + line_height / 2);
    entry.name->setPos(x + sample_px + gap, y + (line_height - entry.name->boundingRect().height()) / 2);
    x += wide + between;
  }
  return legend_.empty() ? 0 : y + line_height - top;
}

void StudyDrawing::lay_out(const QSizeF& room) {
  const double width = std::max(room.width(), 200.0), inner = width - 2 * margin;
  for (QGraphicsTextItem* paragraph : {title_, caption_}) paragraph->setTextWidth(width - 2 * margin + 8);
  title_->setPos(margin - 4, margin - 4);
  const double head = margin + title_->boundingRect().height();
  const double legend = lay_out_legend(width, 0), foot = legend + caption_->boundingRect().height() + margin;

  // As many plots in a row as are legible.
  const int count = static_cast<int>(items_.size());
  const int columns = std::clamp(static_cast<int>(inner / least_plot_width), 1, std::max(count, 1));
  const int rows = (count + columns - 1) / columns;
  const double plot_height = rows == 0 ? 0 : std::max(least_plot_height, (room.height() - head - foot) / rows);
  for (int k = 0; k < count; ++k)
    items_[static_cast<std::size_t>(k)]->lay_out(
        {margin + inner * (k % columns) / columns, head + plot_height * (k / columns), inner / columns, plot_height});
  const double top = head + rows * plot_height;
  lay_out_legend(width, top);
  caption_->setPos(margin - 4, top + legend);
  setSceneRect(0, 0, width, std::max(room.height(), top + foot));
}

QString StudyDrawing::description() const {
  QStringList lines;
  for (const StudyPlot& plot : plots_.plots)
    for (const StudySeries& series : plot.series)
      for (const auto* points : {&series.line, &series.exact})
        for (const StudyPoint& point : *points)
          lines << QString("%1, %2").arg(QString::fromStdString(plot.luminaire), point_text(point));
  return lines.join("\n");
}

}  // namespace lumifield
