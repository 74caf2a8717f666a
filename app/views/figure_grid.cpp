#include "app/views/figure_grid.h"

#include <QEvent>
#include <QGridLayout>
#include <QLabel>

#include "app/views/signal_colours.h"

namespace lumifield {

FigureGrid::FigureGrid(const std::vector<Entry>& entries, QWidget* parent)
    : QWidget(parent), grid_(new QGridLayout(this)) {
  grid_->setContentsMargins(0, 0, 0, 0);
  grid_->setHorizontalSpacing(16);
  grid_->setVerticalSpacing(0);
  for (const Entry& entry : entries) {
    Figure figure{new QLabel(entry.name, this), new QLabel("—", this)};
    QFont small = figure.name->font();
    small.setPointSizeF(0.85 * small.pointSizeF());
    figure.name->setFont(small);
    figure.value->setMinimumWidth(figure.value->fontMetrics().horizontalAdvance(entry.widest));
    figure.value->setTextInteractionFlags(Qt::TextSelectableByMouse);
    figure.value->setFocusPolicy(Qt::NoFocus);
    figures_.push_back(figure);
  }
  set_columns(static_cast<int>(entries.size()));
}

void FigureGrid::set_columns(int columns) {
  const int count = static_cast<int>(figures_.size());
  for (int i = 0; i < count; ++i) {
    const auto& [name, value, warn] = figures_[static_cast<std::size_t>(i)];
    const int row = i / columns, column = i % columns;
    const int span = i == count - 1 ? columns - column : 1;
    grid_->addWidget(name, 3 * row, column, 1, span, Qt::AlignBottom);
    grid_->addWidget(value, 3 * row + 1, column, 1, span, Qt::AlignTop);
    grid_->setRowMinimumHeight(3 * row + 2, columns == count ? 0 : 6);
  }
}

void FigureGrid::show_figure(int index, const QString& value, const QString& tip, bool warn) {
  Figure& figure = figures_.at(static_cast<std::size_t>(index));
  figure.value->setText(warn ? value + " ⚠" : value);
  figure.value->setAccessibleName(figure.name->text() + ": " + value + (warn ? ", warning" : ""));
  for (QLabel* label : {figure.name, figure.value}) label->setToolTip(tip);
  if (figure.warn != warn) {
    figure.warn = warn;
    colour(figure);
  }
}

QString FigureGrid::value(int index) const { return figures_.at(static_cast<std::size_t>(index)).value->text(); }

void FigureGrid::colour(const Figure& figure) {
  QPalette own = figure.value->palette();
  own.setColor(QPalette::WindowText, figure.warn ? warning_colour(palette()) : palette().color(QPalette::WindowText));
  figure.value->setPalette(own);
}

void FigureGrid::changeEvent(QEvent* event) {
  if (event->type() == QEvent::PaletteChange)
    for (const Figure& figure : figures_) colour(figure);
  QWidget::changeEvent(event);
}

}  // namespace lumifield
