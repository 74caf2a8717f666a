#pragma once

#include "renderer/study/study_bench.h"

namespace lumifield {

/// A luminaire and receivers at which methods tend to fail.
struct StabilityCase {
  std::string name;
  LuminaireGeometry geometry;
  std::vector<CellImage> cells;  ///< in the grid's order; an empty image is a missing cell
  std::vector<Receiver> receivers;
  double samples = 200;      ///< K
  double lod = 0;            ///< of the closed form
  bool cut_horizon = false;  ///< the receivers' planes cut supports
};

/// p on S (Δ = ±0, ±1e-9, ±1e-4), on pixel edges there; between the planes; near U and behind it; 10⁵ mm away; n
/// flipped; cut horizons; supports partly or wholly off the images; S not centred over U; one pixel 10⁶ above the rest;
/// no light; light that cancels; negative light; missing cells; NaN and Inf; one cell, one pixel; pyramids of images
/// that are no power of two; bright 4k images; δ/a from 2 to 200; K smaller than the number of cells.
std::vector<StabilityCase> stability_cases();

/// Every method in one case, host form and kernel. A method's mean over seeds, of its host form, must lie within what
/// the method states of itself (five of its standard deviations, bias included), and its kernel too; an answer that the
/// method itself calls worthless, by a deviation larger than the light, is a refusal.
std::vector<StabilityRow> try_case(const StabilityCase& each);

/// All of them.
Result<std::vector<StabilityRow>> stability_table(const StudyProgress& progress);

}  // namespace lumifield
