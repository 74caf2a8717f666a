#pragma once

#include <vector>

#include "luminaire/light_field.h"
#include "luminaire/plan.h"

namespace lumifield {

/// The order in which a grid's cells are visited, each exactly once. Reentrant.
///
/// serpentine: row by row, every other row backwards. coarse_to_fine: of the lattices of every 2^k-th cell in both axes
/// through the central cell, the coarsest first, each as a serpentine of the cells not yet visited, so that any prefix
/// covers the grid evenly.
std::vector<CellIndex> scan_order(ScanOrder order, int columns, int rows);

}  // namespace lumifield
