#pragma once

#include <vector>

#include "luminaire/basis.h"
#include "luminaire/geometry.h"
#include "luminaire/light_field.h"
#include "renderer/methods/image_levels.h"

namespace lumifield {

/// The levels of detail that a trilinear look-up has of an image: 0 … this. Graphics hardware halves a size of odd
/// pixels to less than its half, so images are padded with 0 to a multiple of 2^coarsest; the coarsest level is the one
/// that pads a side by at most an eighth.
int coarsest_spot_level(int width_px, int height_px);
/// A side, so padded.
int padded_spot_size(int size_px, int coarsest);

/// Twice φ's standard deviation: how wide a look-up at level 0 is, in spacings.
double spot_width(const Basis& basis);

/// The level whose look-up blurs as wide as the basis: a bilinear look-up between means of 2^ℓ pixels has on average
/// the variance 4^ℓ/4, φ over `rate` pixels a spacing the variance rate² ∫τ²φ. Of both axes the wider. Between 0 and
/// coarsest: not clamped above by what the basis asks for, since a coarser level is not there.
double spot_level(const Basis& basis, const Vec2& rate, int coarsest);

/// One cell's levels, on the host in double. Value type; refers to the image.
class SpotImage {
 public:
  explicit SpotImage(const CellImage& image);
  /// Trilinear, `at_px` from the image's corner in pixels of level 0; beyond the image is 0.
  double look_up(int channel, const Vec2& at_px, double level) const;

 private:
  double bilinear(int channel, const Vec2& at_px, int level) const;
  double texel(int channel, int i, int j, int level) const;

  const CellImage* image_;
  std::vector<std::vector<ImageLevel>> coarse_;  ///< by channel
};

}  // namespace lumifield
