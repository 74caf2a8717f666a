#include "app/views/grid_selection.h"

#include <algorithm>
#include <utility>

namespace lumifield {

void GridSelection::choose(CellIndex cell) {
  current_ = anchor_ = cell;
  selected_ = {cell};
}

void GridSelection::toggle(CellIndex cell) {
  if (!selected_.insert(cell).second) selected_.erase(cell);
  current_ = anchor_ = cell;
}

void GridSelection::extend_to(CellIndex cell) {
  if (!anchor_) return choose(cell);
  const CellIndex anchor = *anchor_;
  span(anchor, cell, false);
  anchor_ = anchor;
}

void GridSelection::span(CellIndex from, CellIndex to, bool add) {
  if (!add) selected_.clear();
  for (int row = std::min(from.row, to.row); row <= std::max(from.row, to.row); ++row)
    for (int column = std::min(from.column, to.column); column <= std::max(from.column, to.column); ++column)
      selected_.insert({row, column});
  anchor_ = from;
  current_ = to;
}

void GridSelection::set(std::set<CellIndex> cells) {
  selected_ = std::move(cells);
  if (!selected_.empty() && (!current_ || !selected_.contains(*current_))) current_ = anchor_ = *selected_.begin();
}

}  // namespace lumifield
