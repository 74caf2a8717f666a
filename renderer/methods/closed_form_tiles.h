#pragma once

#include "renderer/methods/gloss_shared.h"
#include "renderer/methods/receiver.h"
#include "renderer/visibility/tile_grid.h"

namespace lumifield {

/// The finest parts of a tile that the closed form's gloss is split into, an axis; powers of two up to it.
inline constexpr int most_division = 8;
/// What the lobe may be off between the corners of a subtile, of its peak: where all pixels count, and with a level of
/// detail, which is off by some percent itself.
inline constexpr double exact_gloss = 0.005, detail_gloss = 0.03;
inline double gloss_tolerance(double lod) { return lod > 0 ? detail_gloss : exact_gloss; }

/// Relative error of a lobe that is taken bilinear over subtiles, about its peak: h²/8 ∂²f/f an axis with the angle h
/// that a subtile subtends at most and ∂²f/f of the peak, n for Phong's cosⁿ, 1/α² for GGX (its half vector turns half
/// as much as the light).
/// division 0: a whole support.
double lobe_error(const TileGrid& grid, const Receiver& receiver, const GlossLobe& lobe, int division);

/// The least division of which lobe_error is at most `tolerance`, or most_division: a power of two, or 0 where
/// supports need not be divided at all, since lobe and light allow it.
int gloss_division(const TileGrid& grid, const Receiver& receiver, const GlossLobe& lobe, bool light_is_even,
                   double tolerance);

}  // namespace lumifield
