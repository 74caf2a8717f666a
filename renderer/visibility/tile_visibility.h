#pragma once

#include <cstdint>
#include <vector>

#include "renderer/visibility/tile_grid.h"

namespace lumifield {

/// How a cell's light is weighed by the tests of its n² tiles: each tile's share by its own, or all of it by their mean
/// (Lu 2015, Sec. 6.2).
enum class ShadowWeighing { tile, mean };

/// Which tiles of U each receiver sees, one bit each; by receiver, then row, `row_words` words of 32 columns, the low
/// bit first. Bits beyond the grid are 0. Without receivers: all see all. Value type.
struct TileVisibility {
  TileGrid grid;
  ShadowWeighing weighing = ShadowWeighing::tile;
  std::vector<std::uint32_t> words{};

  bool empty() const { return words.empty(); }
  std::size_t row_words() const { return static_cast<std::size_t>((grid.columns + 31) / 32); }
  std::size_t receiver_words() const { return row_words() * static_cast<std::size_t>(grid.rows); }
  bool sees(std::size_t receiver, int column, int row) const {
    return words[word_of(receiver, column, row)] >> (column % 32) & 1;
  }
  void set_seen(std::size_t receiver, int column, int row) {
    words[word_of(receiver, column, row)] |= 1U << (column % 32);
  }
  /// Of a cell's n² tiles.
  double mean_share(std::size_t receiver, CellIndex cell) const;
  /// What the light of tile (column, row) from one cell is multiplied by: the bit, or the mean of the cell's n² tiles.
  double share(std::size_t receiver, CellIndex cell, int column, int row) const;

 private:
  std::size_t word_of(std::size_t receiver, int column, int row) const {
    return receiver * receiver_words() + static_cast<std::size_t>(row) * row_words() +
           static_cast<std::size_t>(column / 32);
  }
};

/// What a receiver sees of all tiles.
enum class Sight { none, some, all };
Sight sight_of(const TileVisibility& visibility, std::size_t receiver);

}  // namespace lumifield
