#pragma once

#include <vector>

#include "luminaire/basis.h"
#include "luminaire/geometry.h"
#include "luminaire/light_field.h"
#include "renderer/methods/image_levels.h"

namespace lumifield {

/// Twice φ's standard deviation: how wide a look-up at level 0 is, in spacings.
double spot_width(const Basis& basis);

/// The level whose trilinear look-up blurs as wide as the basis: a bilinear one between means of 2^ℓ pixels has on
/// average the variance 4^ℓ/4, φ over `rate` pixels a spacing the variance rate² ∫τ²φ. Of both axes the wider. From 0
/// to `coarsest`.
double spot_level(const Basis& basis, const Vec2& rate, int coarsest);

/// One cell's levels of detail (image_levels.h), on the host in double. Value type; refers to the image.
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

/// Where the levels of an image lie in one layer of a texture: level 0, and the others in a column beside it, a frame
/// of 0 about each. So they are those of image_levels.h, where a texture's own would halve sides of odd pixels to less
/// than their half, and what a level of them costs is two plain look-ups. Value type.
struct SpotLayout {
  struct Level {
    int x_px, y_px, width_px, height_px;
  };
  std::vector<Level> levels;
  int width_px = 0, height_px = 0;  ///< of the layer

  /// Of an image of this size; with level 0 alone, without a frame.
  SpotLayout(int image_width_px, int image_height_px, bool with_levels);
};

}  // namespace lumifield
