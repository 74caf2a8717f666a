#pragma once

#include <QTimer>
#include <QWidget>
#include <memory>
#include <optional>

#include "app/views/cell_figures.h"
#include "app/views/cell_look.h"
#include "app/views/luminaire_model.h"

class QComboBox;
class QLabel;

namespace lumifield {

class ColourBar;
class FigureGrid;
class ImageView;

/// The cell panel: C of one cell on S, seen facing the lamp as the grid is (+x to the right, +y up), in false colour or
/// grey; value and place under the cursor, histogram, quality figures and warnings. Follows the cell as it is measured
/// and taken again. GUI thread.
class CellView : public QWidget {
  Q_OBJECT

 public:
  /// The model outlives it.
  explicit CellView(const LuminaireModel& model, QWidget* parent = nullptr);

  const std::optional<CellIndex>& cell() const { return cell_; }
  const CellLook& look() const { return look_; }

 public slots:
  void show_cell(lumifield::CellIndex cell);

 private:
  QWidget* make_choices();
  void make_histogram_choice();
  void add_choice(QComboBox* choice, const QString& name, const QString& tip);
  void take_look();
  void take_geometry();
  void refresh();
  void refresh_title();
  void refresh_image();
  void refresh_histogram();
  void refresh_figures();
  void refresh_reading();
  const LuminaireModel::Cell* known() const { return cell_ ? model_.cell(*cell_) : nullptr; }
  QString unit() const;

  const LuminaireModel& model_;
  CellFigures figures_;
  std::optional<CellIndex> cell_;
  CellLook look_;
  std::shared_ptr<const CellImage> shown_, counted_;
  int shown_channel_ = 0, counted_channel_ = 0;
  ValueScale scale_;
  QTimer soon_;  ///< other cells move the common scale

  QLabel* title_;
  QComboBox* colours_;
  QComboBox* range_;
  QComboBox* channel_;
  ImageView* image_;
  ColourBar* bar_;
  QLabel* reading_;
  HistogramView* histogram_;
  FigureGrid* quality_;
  QLabel* warnings_;
};

}  // namespace lumifield
