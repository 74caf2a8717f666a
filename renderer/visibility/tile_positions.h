#pragma once

#include <optional>
#include <vector>

#include "luminaire/light_field.h"
#include "renderer/visibility/tile_grid.h"

namespace lumifield {

/// Where on S the light of each tile stands as published (Lu 2015, Sec. 6.2): the mean, over the measured cells that
/// overlap the tile and have light, of their medians; none where there is no such cell. They move as cells come:
/// whoever must not have that keeps the first ones and adds those of tiles that had none. Value type, luminaire frame,
/// mm.
struct TilePositions {
  TileGrid grid;
  std::vector<std::optional<Vec2>> on_s_mm;  ///< by row, then column

  const std::optional<Vec2>& at(int column, int row) const {
    return on_s_mm[static_cast<std::size_t>(row * grid.columns + column)];
  }
  bool operator==(const TilePositions&) const = default;
};

/// Where both CDFs of the importance image Σ_channels |C| are ½: the marginal of x over all rows, then the conditional
/// of the column that this x lies in. None without light. mm on S. Reentrant.
std::optional<Vec2> median_mm(const Measurement& measurement, const CellImage& image);

/// Of the cells measured so far. Reentrant.
TilePositions published_positions(const LightField& light_field);

/// Gives tiles that have no position those of another. Both are of one grid.
void add_missing(TilePositions& positions, const TilePositions& others);

}  // namespace lumifield
