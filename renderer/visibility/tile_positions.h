#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "luminaire/light_field.h"
#include "renderer/visibility/tile_grid.h"

namespace lumifield {

/// Where on S the light of each tile stands as published (Lu 2015, Sec. 6.2): the mean, over the measured cells that
/// overlap the tile and have light, of their medians; none where there is no such cell. They would move as cells come:
/// FirstPositions do not. Value type, luminaire frame, mm.
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

/// Positions of cells that come one after the other: a tile keeps the first that it is given. So a cell that gives some
/// their first changes nothing for those before it, none of which has light and such a tile. The work follows what has
/// come: of images that overlap a tile without a position the median is computed, once each. Value type.
class FirstPositions {
 public:
  explicit FirstPositions(const LuminaireGeometry& geometry);

  /// Whether this image would give a tile of the cell its first; a dark one gives none.
  bool would_give(CellIndex cell, const std::shared_ptr<const CellImage>& image);
  /// Gives tiles without a position that of all cells as they are: by Sampling::flat, null while unmeasured.
  void take(std::span<const std::shared_ptr<const CellImage>> cells);

  const TilePositions& positions() const { return positions_; }
  int medians_computed() const { return medians_computed_; }

 private:
  struct Known {
    std::shared_ptr<const CellImage> image;
    std::optional<Vec2> median;
  };
  bool lacks(CellIndex cell) const;
  const std::optional<Vec2>& median(int flat, const std::shared_ptr<const CellImage>& image);

  Sampling sampling_;
  Measurement measurement_;
  TilePositions positions_;
  std::vector<Known> known_;  ///< of cells that overlap a tile without one
  int medians_computed_ = 0;
};

/// The images as FirstPositions take them.
std::vector<std::shared_ptr<const CellImage>> images_by_cell(const LightField& light_field);

/// Of the cells measured so far. Reentrant.
TilePositions published_positions(const LightField& light_field);

}  // namespace lumifield
