#pragma once

#include <QWidget>
#include <vector>

class QDoubleSpinBox;
class QGridLayout;
class QListWidget;
class QPushButton;

namespace lumifield {

class LampArrangement;

/// The scene's luminaires as a list, and where the chosen one stands, in numbers to be edited. GUI thread.
class LampsPanel : public QWidget {
  Q_OBJECT

 public:
  /// `lamps` outlives the panel's use of it.
  explicit LampsPanel(LampArrangement& lamps, QWidget* parent = nullptr);

 private:
  /// A number of the chosen lamp.
  enum class Figure { x, y, z, yaw, pitch, roll, scale };
  void make_figures(QGridLayout* grid);
  QDoubleSpinBox* make_figure(Figure figure);
  QWidget* make_buttons();
  void change(Figure figure, double value);
  void show_lamps();
  void show_figures();

  LampArrangement& lamps_;
  QListWidget* list_;
  std::vector<QDoubleSpinBox*> figures_;  ///< by Figure
  QPushButton *add_ = nullptr, *remove_ = nullptr, *back_ = nullptr;
};

}  // namespace lumifield
