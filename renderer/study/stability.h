#pragma once

#include "renderer/methods/appearance.h"
#include "renderer/study/study_bench.h"

namespace lumifield {

/// A luminaire and receivers at which methods tend to fail.
struct StabilityCase {
  std::string name;
  LuminaireGeometry geometry;
  std::vector<CellImage> cells;  ///< in the grid's order; an empty image is a missing cell
  std::vector<Receiver> receivers;
  double samples = 200;  ///< K; lights are ten times as many
  double lod = 0;        ///< of the closed form
  Appearance appearance{};
};

/// What receivers look like beside diffuse and unoccluded: half of the tiles seen, in a pattern that has no symmetry;
/// and a GGX lobe (roughness 0.3) that mirrors the middle of the grid, in such a half-shadow.
enum class StabilityLook { plain, half_shadow, glossy };
/// The case with its receivers looking so, its name telling.
StabilityCase with_look(StabilityCase each, StabilityLook look);

/// p on S (Δ = ±0, ±1e-9, ±1e-4), on pixel edges there; between the planes; near U and behind it; 10⁵ mm away; n
/// flipped; cut horizons; supports partly or wholly off the images; S not centred over U; one pixel 10⁶ above the rest;
/// no light; light that cancels; negative light; missing cells; NaN and Inf; one cell, one pixel; pyramids of images
/// that are no power of two; bright 4k images; δ/a from 2 to 200; K smaller than the number of cells.
std::vector<StabilityCase> stability_cases();

/// Errors: cells that no luminaire can have, the cell named.
Result<LightField> luminaire_of(const StabilityCase& each);

/// Every method in one case, host form and kernel (stability_judge.h).
std::vector<StabilityRow> try_case(const StabilityCase& each);

/// All of them.
Result<std::vector<StabilityRow>> stability_table(const StudyProgress& progress);

}  // namespace lumifield
