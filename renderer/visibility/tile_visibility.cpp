#include "renderer/visibility/tile_visibility.h"

#include <bit>

namespace lumifield {

double TileVisibility::mean_share(std::size_t receiver, CellIndex cell) const {
  int seen = 0;
  for (int k = 0; k < grid.per_support; ++k)
    for (int i = 0; i < grid.per_support; ++i) seen += sees(receiver, cell.column + i, cell.row + k);
  return static_cast<double>(seen) / (grid.per_support * grid.per_support);
}

double TileVisibility::share(std::size_t receiver, CellIndex cell, int column, int row) const {
  if (weighing == ShadowWeighing::tile) return sees(receiver, column, row) ? 1 : 0;
  return mean_share(receiver, cell);
}

Sight sight_of(const TileVisibility& visibility, std::size_t receiver) {
  int seen = 0;
  const std::size_t begin = receiver * visibility.receiver_words();
  for (std::size_t k = begin; k < begin + visibility.receiver_words(); ++k) seen += std::popcount(visibility.words[k]);
  return seen == 0 ? Sight::none : seen == visibility.grid.tiles() ? Sight::all : Sight::some;
}

}  // namespace lumifield
