#pragma once

#include <span>

#include "luminaire/light_field.h"

namespace lumifield {

/// An image in a batch, and whether it is added or taken away.
struct BatchCell {
  CellIndex index;
  const CellImage* image;
  double sign;
};

/// Cells that one run of the closed form's kernels takes, sorted, and the part of the grid that they span: the grid is
/// cut into tiles of GRID_CELLS rows and columns. Value type; reads the batch that it is made of.
struct Tile {
  std::span<const BatchCell> cells;
  CellIndex first;
  int rows, columns;

  explicit Tile(std::span<const BatchCell> all);
  /// Whether what the cells of its rows and columns share is worth the taking; the grid's kernel takes no cell away.
  bool is_dense() const;
};

/// The number of the tile that a cell is in.
CellIndex tile_of(CellIndex cell);

/// The first cells of a sorted batch, those of one tile.
Tile first_tile(std::span<const BatchCell> batch);

}  // namespace lumifield
