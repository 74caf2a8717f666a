#pragma once

#include <array>

#include "app/session/learned_cost.h"

namespace lumifield {

/// How finely a picture is made. Value type.
struct PreviewDetail {
  int divisor = 1;  ///< of width and height
  double lod = 0;   ///< level of detail T, 0 exact
  bool full() const { return divisor == 1 && lod == 0; }
  bool operator==(const PreviewDetail&) const = default;
};

/// What a picture takes: to draw it, to sum each cell and to show it has a fixed part and one for each receiver,
/// learned from those made. Coarse and full ones apart; a full one is expected to cost as the coarse ones until the
/// first is made. Thread-bound.
class PreviewCosts {
 public:
  void drawn(PreviewDetail detail, double receivers, double seconds);
  void summed(PreviewDetail detail, double receivers, int cells, double seconds);
  void shown(PreviewDetail detail, double receivers, double seconds);

  /// `receivers`: pixels of the picture as it is made, divisor applied, times luminaires.
  double picture_s(PreviewDetail detail, double receivers, int cells) const;
  double cell_s(PreviewDetail detail, double receivers) const;
  /// Some cells have been summed.
  bool known() const { return costs_[0].learned || costs_[1].learned; }

  /// The finest that takes no longer than `seconds`, or the coarsest there is. So that detail does not flicker, one
  /// finer than `before` has to fit well, and `before` nearly.
  PreviewDetail finest_within(double seconds, double full_receivers, int cells, PreviewDetail before) const;

 private:
  struct Costs {
    LearnedCost draw, cell, show;
    bool learned = false;  ///< what a cell takes
  };
  /// Two cores with PoCL and llvmpipe, until measured. Coarse, full.
  std::array<Costs, 2> costs_{Costs{{1e-3, 1e-7}, {2e-4, 3e-8}, {1e-4, 3e-8}},
                              Costs{{1e-3, 1e-7}, {2e-4, 5e-8}, {1e-4, 3e-8}}};
  Costs& of(PreviewDetail detail) { return costs_[detail.full() ? 1 : 0]; }
  const Costs& expected(PreviewDetail detail) const {
    return costs_[detail.full() && (costs_[1].learned || !costs_[0].learned) ? 1 : 0];
  }
};

/// Whether cells that wait for a full picture are to be shown coarsely first. That costs the full one all its cells
/// again, so they must be many: as from a dataset that is opened, not from a scan on a slow machine.
bool shows_coarsely_first(int waiting, int cells, double cell_s);
/// The same where all cells are computed together: `fresh` of them are in no picture yet.
bool shows_all_coarsely_first(int fresh, int cells, double cell_s);
/// For a method of which nothing is known.
PreviewDetail coarsest();

}  // namespace lumifield
