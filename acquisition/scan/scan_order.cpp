#include "acquisition/scan/scan_order.h"

#include <algorithm>
#include <bit>

namespace lumifield {

namespace {

/// Serpentine over the cells (row0 + i·stride, column0 + j·stride) that `taken` does not mark; marks them.
void append_serpentine(int columns, int rows, CellIndex first, int stride, std::vector<bool>& taken,
                       std::vector<CellIndex>& order) {
  bool backwards = false;
  for (int row = first.row; row < rows; row += stride) {
    const auto begin = order.size();
    for (int column = first.column; column < columns; column += stride) {
      const auto flat =
          static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) + static_cast<std::size_t>(column);
      if (!taken[flat]) order.push_back({row, column});
      taken[flat] = true;
    }
    if (backwards) std::reverse(order.begin() + static_cast<std::ptrdiff_t>(begin), order.end());
    backwards = !backwards;
  }
}

}  // namespace

std::vector<CellIndex> scan_order(ScanOrder kind, int columns, int rows) {
  const auto cells = static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows);
  std::vector<bool> taken(cells, false);
  std::vector<CellIndex> order;
  order.reserve(cells);

  int stride = 1;
  if (kind == ScanOrder::coarse_to_fine)
    stride = static_cast<int>(std::bit_ceil(static_cast<unsigned>(std::max({columns, rows, 2}))) / 2);
  for (; stride >= 1; stride /= 2)
    append_serpentine(columns, rows, {(rows / 2) % stride, (columns / 2) % stride}, stride, taken, order);
  return order;
}

}  // namespace lumifield
