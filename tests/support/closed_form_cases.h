#pragma once

#include <string>
#include <vector>

#include "luminaire/light_field.h"

namespace lumifield {

/// Receivers at which irradiance methods tend to fail, by name of the difficulty.
struct ReceiverCase {
  std::string name;
  Vec3 p_mm, n;
  bool cut_horizon = false;  ///< the receiver's plane cuts supports
};

/// A random luminaire: non-square pixels and spacings, off-centre grids, a fifth of the cells missing, a third of the
/// values negative, and one pixel 10⁶ above the rest. Pixel edges and cell centres are dyadic, so that a receiver can
/// stand exactly on them.
LightField random_luminaire(BasisKind basis, int channels, unsigned seed);

/// The receivers for random_luminaire, seeded random places of every kind.
std::vector<ReceiverCase> receiver_cases(const LuminaireGeometry& geometry, unsigned seed);

}  // namespace lumifield
