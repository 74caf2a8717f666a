#include "renderer/methods/closed_form_tile.h"

#include <algorithm>

#include "renderer/methods/closed_form_shared.h"

namespace lumifield {

Tile::Tile(std::span<const BatchCell> all) : cells(all), first(all.front().index) {
  CellIndex last = first;
  for (const BatchCell& each : all) {
    first = {std::min(first.row, each.index.row), std::min(first.column, each.index.column)};
    last = {std::max(last.row, each.index.row), std::max(last.column, each.index.column)};
  }
  rows = last.row - first.row + 1;
  columns = last.column - first.column + 1;
}

bool Tile::is_dense() const {
  return 2 * cells.size() > static_cast<std::size_t>(rows + columns) &&
         std::all_of(cells.begin(), cells.end(), [](const BatchCell& each) { return each.sign > 0; });
}

CellIndex tile_of(CellIndex cell) { return {cell.row / GRID_CELLS, cell.column / GRID_CELLS}; }

Tile first_tile(std::span<const BatchCell> batch) {
  const auto end = std::find_if(batch.begin(), batch.end(), [&](const BatchCell& each) {
    return tile_of(each.index) != tile_of(batch.front().index);
  });
  return Tile(batch.first(static_cast<std::size_t>(end - batch.begin())));
}

}  // namespace lumifield
