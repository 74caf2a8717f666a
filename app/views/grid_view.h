#pragma once

#include <QTimer>
#include <QWidget>
#include <vector>

#include "app/views/luminaire_model.h"

class QComboBox;
class QPushButton;

namespace lumifield {

class ColourBar;
class GridMap;
class StateLegend;

/// The grid panel: the map of cells, what it is coloured by, the scale of its colours, the legend of states with their
/// counts, and the retake of selected cells. Scale and counts follow the model at most 25 times a second. GUI thread.
class GridView : public QWidget {
  Q_OBJECT

 public:
  /// The model outlives it.
  explicit GridView(const LuminaireModel& model, QWidget* parent = nullptr);

  GridMap& map() { return *map_; }
  /// Whether cells can be taken again at present; `reason` says why not.
  void set_retake_possible(bool possible, const QString& reason = {});

 signals:
  void cellSelected(lumifield::CellIndex cell);
  /// Enter or double-click.
  void cellOpened(lumifield::CellIndex cell);
  void retakeRequested(std::vector<lumifield::CellIndex> cells);

 private:
  QWidget* make_colour_choice();
  void colour_by(int choice);
  void refresh_soon();
  void refresh();
  void refresh_retake();

  const LuminaireModel& model_;
  GridMap* map_;
  QComboBox* colouring_;
  ColourBar* bar_;
  StateLegend* legend_;
  QPushButton* retake_;
  QTimer soon_;
  bool retake_possible_ = true;
  QString retake_reason_;
};

}  // namespace lumifield
