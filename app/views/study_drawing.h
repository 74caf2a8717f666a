#pragma once

#include <QFont>
#include <QGraphicsScene>
#include <QPalette>
#include <memory>
#include <vector>

#include "app/session/study_plots.h"
#include "app/views/study_plot_item.h"

class QGraphicsTextItem;

namespace lumifield {

/// The chart of a study as a scene: a log-log plot for each luminaire, all with the same axes, side by side as far as
/// the room allows; a legend and what the figures are of below. GUI thread.
class StudyDrawing : public QGraphicsScene {
 public:
  StudyDrawing(const Study& study, const QPalette& palette, const QFont& font, QObject* parent = nullptr);

  /// Fits it to a room of this size, in px; it becomes higher where the plots need it. sceneRect() tells the size
  /// taken.
  void lay_out(const QSizeF& room);

  /// Its points in words, for those who do not see it.
  QString description() const;

 private:
  struct LegendEntry {
    QGraphicsItem* mark;
    QGraphicsSimpleTextItem* name;
  };
  QGraphicsTextItem* add_paragraph(const QString& text, const QFont& font, const QColor& colour);
  void add_legend();
  /// Height taken.
  double lay_out_legend(double width, double top);

  StudyPlots plots_;
  QPalette palette_;
  QFont font_;
  QGraphicsTextItem *title_, *caption_;
  std::vector<std::unique_ptr<StudyPlotItem>> items_;
  std::vector<LegendEntry> legend_;
};

}  // namespace lumifield
