#include "app/views/stability_view.h"

#include <QEvent>
#include <QHeaderView>

#include "app/views/stability_model.h"

namespace lumifield {

StabilityView::StabilityView(QWidget* parent) : QTableView(parent), model_(new StabilityModel(this)) {
  setModel(model_);
  model_->set_palette(palette());
  setAccessibleName("Stability of the methods");
  setAccessibleDescription("Cases in which methods fail, by methods: ok, refused or failed, with the largest error");
  setSelectionMode(QAbstractItemView::SingleSelection);
  setEditTriggers(QAbstractItemView::NoEditTriggers);
  setTabKeyNavigation(false);
  setHorizontalScrollMode(QAbstractItemView::ScrollPerPixel);
  setVerticalScrollMode(QAbstractItemView::ScrollPerPixel);
  setCornerButtonEnabled(false);
  for (QHeaderView* header : {horizontalHeader(), verticalHeader()}) {
    header->setHighlightSections(false);
    header->setSectionsClickable(false);
  }
  constexpr int widest_case_px = 280;
  verticalHeader()->setMaximumWidth(widest_case_px);
  verticalHeader()->setTextElideMode(Qt::ElideRight);
  verticalHeader()->setDefaultAlignment(Qt::AlignLeft | Qt::AlignVCenter);
  horizontalHeader()->setSectionResizeMode(QHeaderView::ResizeToContents);
  verticalHeader()->setSectionResizeMode(QHeaderView::Fixed);
  verticalHeader()->setDefaultSectionSize(fontMetrics().height() + 8);
}

void StabilityView::set_study(const Study& study) { model_->set_rows(study.stability); }

void StabilityView::changeEvent(QEvent* event) {
  QTableView::changeEvent(event);
  if (event->type() == QEvent::PaletteChange) model_->set_palette(palette());
}

}  // namespace lumifield
