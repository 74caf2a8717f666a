#pragma once

#include "luminaire/light_field.h"

namespace lumifield {

/// U cut into the tiles that supports overlap: as wide as the cells' spacing, from the first support's low end to the
/// last one's high end, so that every support is n×n whole tiles, n = 1 (box), 2 (tent, bell), 3 (bspline2). Tile
/// (column, row) belongs to the cells (column − n + 1 … column, row − n + 1 … row) (Lu 2015, Sec. 6.2). Value type,
/// luminaire frame.
struct TileGrid {
  int columns = 0, rows = 0;
  int per_support = 1;  ///< n, an axis
  Vec2 corner_mm{0, 0};
  Vec2 size_mm{0, 0};  ///< of a tile: a

  explicit TileGrid(const Sampling& sampling);
  TileGrid() = default;
  int tiles() const { return columns * rows; }
  Vec2 center_mm(int column, int row) const { return corner_mm + size_mm.cwiseProduct(Vec2(column + 0.5, row + 0.5)); }
  bool operator==(const TileGrid&) const = default;
};

}  // namespace lumifield
