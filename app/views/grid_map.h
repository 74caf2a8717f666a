#pragma once

#include <QString>
#include <QWidget>
#include <optional>
#include <set>
#include <vector>

#include "app/views/cell_figures.h"
#include "app/views/grid_selection.h"
#include "app/views/luminaire_model.h"

namespace lumifield {

/// The cells of the luminaire as a map, seen facing the lamp with its light coming towards the viewer: +x to the right,
/// +y up, rows counted upwards. Coloured by state or by a figure; chosen with mouse (click, Ctrl and Shift, rubber
/// band) and keys (arrows, with Shift to extend, Ctrl+Space to toggle, Ctrl+A, Enter opens). 1 × 1 to 40 × 40 cells.
/// GUI thread.
class GridMap : public QWidget {
  Q_OBJECT

 public:
  /// The model outlives it.
  explicit GridMap(const LuminaireModel& model, QWidget* parent = nullptr);

  /// Coloured by state when empty.
  void set_figure(std::optional<CellFigure> figure);
  const std::optional<CellFigure>& figure() const { return figure_; }
  const ValueScale& scale() const { return scale_; }
  const CellFigures& figures() const { return figures_; }
  /// The figure's ends over the cells measured by now.
  void refresh_scale();

  const std::optional<CellIndex>& current() const { return selection_.current(); }
  const std::set<CellIndex>& selected() const { return selection_.selected(); }
  /// Those selected that can be taken again: measured, and not yet waiting for it.
  std::vector<CellIndex> retakable() const;
  /// Whether cells can be taken again at present, and why not.
  void set_retake_possible(bool possible, const QString& reason);

  QRectF cell_rect(CellIndex cell) const;
  std::optional<CellIndex> cell_at(const QPointF& position) const;
  /// Where the pointer is: the cell's figures, or how the map lies.
  QString text_at(const QPointF& position) const;

  QSize sizeHint() const override;
  QSize minimumSizeHint() const override;

 public slots:
  /// Chooses one alone; nothing when it lies outside the grid.
  void choose(lumifield::CellIndex cell);
  void select_warned();
  void select_all();
  /// Asks for the selected cells that can be taken again.
  void request_retake();

 signals:
  /// Another cell is current.
  void cellSelected(lumifield::CellIndex cell);
  void selectionChanged();
  /// Enter or double-click.
  void cellOpened(lumifield::CellIndex cell);
  void retakeRequested(std::vector<lumifield::CellIndex> cells);

 protected:
  bool event(QEvent* event) override;
  void paintEvent(QPaintEvent* event) override;
  void mousePressEvent(QMouseEvent* event) override;
  void mouseMoveEvent(QMouseEvent* event) override;
  void mouseReleaseEvent(QMouseEvent* event) override;
  void mouseDoubleClickEvent(QMouseEvent* event) override;
  void keyPressEvent(QKeyEvent* event) override;
  void contextMenuEvent(QContextMenuEvent* event) override;

 private:
  struct Layout {
    QPointF corner;       ///< upper left of all cells
    double x = 0, y = 0;  ///< from cell to cell
    double gap = 0;
  };
  Layout layout_cells() const;
  CellIndex nearest_cell(const QPointF& position) const;
  void forget();
  void select(const GridSelection& selection);
  void move_current(int rows, int columns, bool extend);
  void paint_cell(QPainter& painter, CellIndex cell, const QRectF& rect) const;
  void paint_value(QPainter& painter, CellIndex cell, const QRectF& rect) const;
  void paint_selection(QPainter& painter) const;
  void paint_axes(QPainter& painter) const;

  const LuminaireModel& model_;
  CellFigures figures_;
  std::optional<CellFigure> figure_;
  ValueScale scale_;
  GridSelection selection_;
  std::optional<QPointF> pressed_;
  QRectF band_;  ///< the rubber band while it is drawn
  bool retake_possible_ = true;
  QString retake_reason_;
};

}  // namespace lumifield
