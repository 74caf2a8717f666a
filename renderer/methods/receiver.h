#pragma once

#include "luminaire/geometry.h"

namespace lumifield {

/// A point of a surface that is lit, in the luminaire frame: p in mm, n of unit length.
struct Receiver {
  Vec3 p_mm{0, 0, 0};
  Vec3 n{0, 0, 1};
};

/// A receiver nearer to U than this, but in front of it, counts as this far from it: E is continuous there and changes
/// by some 1e-9, while n·(u−p) and the pixels seen, ever narrower on U, would lose their digits in double. Far less,
/// and the height's cube is 0.
inline constexpr double least_height_mm = 1e-9;

/// The height that a receiver counts with, mm. On U and behind it, where it gets none of the light, it stays, as do
/// NaN and Inf.
inline double lit_height_mm(double z_mm) { return z_mm > 0 && z_mm < least_height_mm ? least_height_mm : z_mm; }
inline Receiver at_lit_height(Receiver receiver) {
  receiver.p_mm.z() = lit_height_mm(receiver.p_mm.z());
  return receiver;
}

}  // namespace lumifield
