#include "app/views/grid_view.h"

#include <QComboBox>
#include <QHBoxLayout>
#include <QLabel>
#include <QPushButton>
#include <QVBoxLayout>
#include <algorithm>

#include "app/views/colour_bar.h"
#include "app/views/grid_map.h"
#include "app/views/state_legend.h"

namespace lumifield {

GridView::GridView(const LuminaireModel& model, QWidget* parent)
    : QWidget(parent),
      model_(model),
      map_(new GridMap(model, this)),
      colouring_(new QComboBox(this)),
      bar_(new ColourBar(this)),
      legend_(new StateLegend(this)),
      retake_(new QPushButton(tr("&Retake"), this)) {
  auto* column = new QVBoxLayout(this);
  column->setContentsMargins(6, 6, 6, 6);
  column->addWidget(make_colour_choice());
  column->addWidget(map_, 1);
  column->addWidget(bar_);
  column->addWidget(legend_);
  // Its room stays, so that no other panel moves when it comes.
  QSizePolicy kept = bar_->sizePolicy();
  kept.setRetainSizeWhenHidden(true);
  bar_->setSizePolicy(kept);
  bar_->hide();
  retake_->setAccessibleName(tr("Retake selected cells"));

  soon_.setSingleShot(true);
  soon_.setInterval(40);
  connect(&soon_, &QTimer::timeout, this, &GridView::refresh);
  connect(&model, &LuminaireModel::cellChanged, this, &GridView::refresh_soon);
  connect(&model, &LuminaireModel::stateChanged, this, &GridView::refresh_soon);
  connect(&model, &LuminaireModel::resetDone, this, &GridView::refresh);
  connect(map_, &GridMap::cellSelected, this, &GridView::cellSelected);
  connect(map_, &GridMap::cellOpened, this, &GridView::cellOpened);
  connect(map_, &GridMap::retakeRequested, this, &GridView::retakeRequested);
  connect(map_, &GridMap::selectionChanged, this, &GridView::refresh_retake);
  connect(retake_, &QPushButton::clicked, map_, &GridMap::request_retake);
  refresh();
}

QWidget* GridView::make_colour_choice() {
  auto* row = new QWidget(this);
  auto* line = new QHBoxLayout(row);
  line->setContentsMargins(0, 0, 0, 0);
  auto* label = new QLabel(tr("&Colour by"), row);
  label->setBuddy(colouring_);
  colouring_->setAccessibleName(tr("What the cells are coloured by"));
  colouring_->addItem(tr("State"));
  colouring_->setItemData(0, tr("Unmeasured, measuring, waiting, measured, warned, damaged"), Qt::ToolTipRole);
  for (const CellFigure figure : all_cell_figures) {
    colouring_->addItem(figure_name(figure));
    colouring_->setItemData(colouring_->count() - 1, figure_meaning(figure), Qt::ToolTipRole);
  }
  line->addWidget(label);
  line->addWidget(colouring_, 1);
  line->addWidget(retake_);
  connect(colouring_, &QComboBox::currentIndexChanged, this, &GridView::colour_by);
  colour_by(0);
  return row;
}

void GridView::colour_by(int choice) {
  map_->set_figure(choice > 0 ? std::optional(all_cell_figures.at(static_cast<std::size_t>(choice - 1)))
                              : std::nullopt);
  colouring_->setToolTip(colouring_->itemData(choice, Qt::ToolTipRole).toString());
  bar_->setVisible(choice > 0);
  legend_->set_by_figure(choice > 0);
  refresh();
}

void GridView::refresh_soon() {
  if (!soon_.isActive()) soon_.start();
}

void GridView::refresh() {
  map_->refresh_scale();
  if (const std::optional<CellFigure>& figure = map_->figure()) {
    const Quantity quantity = model_.geometry() ? model_.geometry()->quantity : Quantity::relative;
    bar_->set_scale(map_->scale(), figure_name(*figure), figure_unit(*figure, quantity));
  }
  std::array<int, all_cell_states.size()> counts{};
  for (int k = 0; k < model_.total(); ++k) {
    const LuminaireModel::State state = model_.state(model_.geometry()->sampling.index(k));
    ++counts.at(static_cast<std::size_t>(std::ranges::find(all_cell_states, state) - all_cell_states.begin()));
  }
  legend_->set_counts(counts);
  refresh_retake();
}

void GridView::set_retake_possible(bool possible, const QString& reason) {
  retake_possible_ = possible;
  retake_reason_ = reason;
  map_->set_retake_possible(possible, reason);
  refresh_retake();
}

void GridView::refresh_retake() {
  const std::size_t cells = map_->retakable().size();
  retake_->setText(cells == 0 ? tr("&Retake") : tr("&Retake %1").arg(cells));
  retake_->setEnabled(retake_possible_ && cells > 0);
  if (!retake_possible_)
    retake_->setToolTip(retake_reason_);
  else
    retake_->setToolTip(cells > 0 ? tr("Takes the selected measured cells again, next (%1 cells)").arg(cells)
                                  : tr("Select measured cells to take them again"));
}

}  // namespace lumifield
