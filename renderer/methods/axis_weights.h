#pragma once

#include <vector>

#include "luminaire/basis.h"

namespace lumifield {

/// One axis of a receiver in front of the two planes. Its height over U is given rather than Δ, whose rounding would be
/// coarse near U.
struct ReceiverAxis {
  double separation_mm;  ///< δ
  double height_mm;      ///< δ + Δ > 0
  double p_mm;

  double t() const { return separation_mm / height_mm; }
  double r() const { return (height_mm - separation_mm) / height_mm; }
};

/// One axis of a cell and of the pixel grid it is measured on.
struct CellAxis {
  double u_mm;        ///< centre of the cell on U
  double spacing_mm;  ///< a
  double corner_mm;   ///< edge of pixel 0 on S
  double pixel_mm;
  int pixels;
};

/// The pixels of one axis that a cell's support shows to a receiver, as intervals of the basis coordinate τ = (u −
/// u_m)/a, each with the moments W0 = ∫φ dτ and W1 = ∫τφ dτ over its part of the support. Every width is a pixel's
/// exact width or a distance to a knot, never a difference of antiderivatives, so that narrow pixels keep full relative
/// accuracy. Value type.
struct AxisWeights {
  struct Pixel {
    double low, high;  ///< τ, clipped to the support
    double w0, w1;
    double width = 0;  ///< exact, of a pixel that nothing clips; else 0
  };
  int first = 0;  ///< index of pixels[0] on S
  std::vector<Pixel> pixels;
};

/// Empty where the support misses the image.
AxisWeights axis_weights(const Basis& basis, const ReceiverAxis& receiver, const CellAxis& cell);

}  // namespace lumifield
