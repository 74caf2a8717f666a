#include "renderer/visibility/tile_grid.h"

namespace lumifield {

TileGrid::TileGrid(const Sampling& sampling)
    : per_support(Basis(sampling.basis).overlap()), size_mm(sampling.spacing_mm) {
  columns = sampling.columns + per_support - 1;
  rows = sampling.rows + per_support - 1;
  corner_mm = sampling.cell_center_mm({0, 0}) - per_support / 2.0 * size_mm;
}

}  // namespace lumifield
