#include "app/views/state_legend.h"

#include <QGridLayout>
#include <QLabel>
#include <QPainter>

#include "renderer/false_colour.h"

namespace lumifield {

namespace {

constexpr int columns = 3, swatch_side = 16;

class Swatch : public QWidget {
 public:
  Swatch(LuminaireModel::State state, const bool& by_figure, QWidget* parent)
      : QWidget(parent), state_(state), by_figure_(by_figure) {
    setFixedSize(swatch_side, swatch_side);
  }

 protected:
  void paintEvent(QPaintEvent*) override {
    QPainter painter(this);
    if (by_figure_ && state_ == LuminaireModel::State::measured)
      paint_colours(painter);
    else
      paint_state(painter, rect(), state_, palette());
  }

 private:
  void paint_colours(QPainter& painter) const {
    for (int x = 0; x < width(); ++x) {
      const auto [r, g, b] = false_colour((x + 0.5) / width());
      painter.fillRect(x, 0, 1, height(), QColor(r, g, b));
    }
  }

  LuminaireModel::State state_;
  const bool& by_figure_;
};

}  // namespace

StateLegend::StateLegend(QWidget* parent) : QWidget(parent) {
  setAccessibleName(tr("States of the cells"));
  auto* grid = new QGridLayout(this);
  grid->setContentsMargins(0, 0, 0, 0);
  grid->setHorizontalSpacing(6);
  grid->setVerticalSpacing(3);
  for (std::size_t k = 0; k < all_cell_states.size(); ++k) {
    const int row = static_cast<int>(k) / columns, column = static_cast<int>(k) % columns;
    labels_[k] = new QLabel(this);
    grid->addWidget(new Swatch(all_cell_states[k], by_figure_, this), row, 2 * column);
    grid->addWidget(labels_[k], row, 2 * column + 1);
    grid->setColumnStretch(2 * column + 1, 1);
  }
  set_counts({});
}

void StateLegend::set_by_figure(bool by_figure) {
  by_figure_ = by_figure;
  for (QWidget* swatch : findChildren<QWidget*>()) swatch->update();
}

void StateLegend::set_counts(const std::array<int, all_cell_states.size()>& counts) {
  counts_ = counts;
  QString all;
  for (std::size_t k = 0; k < counts.size(); ++k) {
    const QString text = tr("%1: %2").arg(state_name(all_cell_states[k])).arg(counts[k]);
    labels_[k]->setText(text);
    labels_[k]->setToolTip(tr("Number of cells: %1").arg(text));
    all += (all.isEmpty() ? QString() : QStringLiteral(", ")) + text;
  }
  setAccessibleDescription(all);
}

}  // namespace lumifield
