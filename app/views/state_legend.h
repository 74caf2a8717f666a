#pragma once

#include <QWidget>
#include <array>

#include "app/views/cell_marks.h"

class QLabel;

namespace lumifield {

/// The marks of the states and how many cells are in each. GUI thread.
class StateLegend : public QWidget {
  Q_OBJECT

 public:
  explicit StateLegend(QWidget* parent = nullptr);
  void set_counts(const std::array<int, all_cell_states.size()>& counts);
  const std::array<int, all_cell_states.size()>& counts() const { return counts_; }
  /// Measured cells show a figure's colours instead of their state's.
  void set_by_figure(bool by_figure);

 private:
  std::array<int, all_cell_states.size()> counts_{};
  bool by_figure_ = false;
  std::array<QLabel*, all_cell_states.size()> labels_{};
};

}  // namespace lumifield
