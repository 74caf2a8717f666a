#pragma once

#include <optional>
#include <set>

#include "luminaire/light_field.h"

namespace lumifield {

/// Which cells are chosen, as lists and tables do it: one is current, any number are selected; a range reaches from the
/// anchor, where it began. Rows and columns as of Sampling. Value type.
class GridSelection {
 public:
  const std::optional<CellIndex>& current() const { return current_; }
  const std::set<CellIndex>& selected() const { return selected_; }

  void clear() { *this = {}; }
  /// This one alone.
  void choose(CellIndex cell);
  /// Into the selection, or out of it.
  void toggle(CellIndex cell);
  /// The rectangle from the anchor to it; without an anchor, it alone.
  void extend_to(CellIndex cell);
  /// The rectangle between two; beside what is selected when `add`. `to` becomes current.
  void span(CellIndex from, CellIndex to, bool add);
  void set(std::set<CellIndex> cells);

 private:
  std::optional<CellIndex> current_, anchor_;
  std::set<CellIndex> selected_;
};

}  // namespace lumifield
