#pragma once

#include <QFont>
#include <QPalette>
#include <QPointF>
#include <QRectF>
#include <QString>
#include <vector>

#include "app/session/study_plots.h"

class QChart;
class QGraphicsItem;
class QGraphicsPathItem;
class QGraphicsScene;
class QGraphicsSimpleTextItem;

namespace lumifield {

/// The plot of one luminaire in a scene, which owns its items: grid and axes, a line for each method and device, a mark
/// for each point. Names stand at single points, at exact ones and at the ends of lines, where nothing is in the way.
/// The tooltip of a mark tells its whole point. GUI thread.
class StudyPlotItem {
 public:
  StudyPlotItem(const StudyPlots& plots, const StudyPlot& plot, const QPalette& palette, const QFont& font,
                QGraphicsScene& scene);

  void lay_out(const QRectF& place);

 private:
  struct Mark {
    QGraphicsPathItem *shape, *arrow;  ///< arrow: of an exact point, else null
    double time_ms, error_percent;
  };
  struct Name {
    QGraphicsSimpleTextItem* text;
    std::size_t mark;
  };
  void add_axes();
  void add_series(const StudySeries& series);
  void add_mark(const StudyPoint& point, bool exact);
  void add_name(const QString& text);
  void place_marks();
  void place_names();
  QPointF position(const Mark& mark) const;
  std::vector<QRectF> taken() const;

  const StudyPlots& plots_;
  QPalette palette_;
  QFont font_;
  QChart* chart_;
  QGraphicsSimpleTextItem* title_ = nullptr;
  QString name_;
  QRectF area_;  ///< within the axes
  std::vector<Mark> marks_;
  std::vector<Name> names_;
  std::vector<std::pair<std::size_t, std::size_t>> segments_;  ///< marks joined by a line
};

/// A text in the palette's colour `role`, owned by the scene or by `parent`.
QGraphicsSimpleTextItem* add_plain_text(QGraphicsScene& scene, QGraphicsItem* parent, const QString& text,
                                        const QFont& font, const QColor& colour);

/// "closed-form, T = 4: relative RMSE 0.31 %, 12.4 ms".
QString point_text(const StudyPoint& point);

/// Between text and base: for what is less important, still at 4.5 to 1.
QColor quiet_colour(const QPalette& palette);

}  // namespace lumifield
