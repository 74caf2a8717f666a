#pragma once

#include <vector>

namespace lumifield {

/// The levels of detail of an image on S. Level ℓ holds the means of 2^ℓ×2^ℓ pixels of the image, padded with 0 to
/// whole ones, so that its pixel edges are edges of the image's own pixels. Level 0 is the image; the coarsest has one
/// pixel.
struct ImageLevel {
  int width_px = 0, height_px = 0;
  std::vector<double> value;  ///< one channel, row by row
};

/// The number of the coarsest level of an image.
int coarsest_level(int width_px, int height_px);

/// Levels 1 … coarsest of one channel.
std::vector<ImageLevel> coarse_levels(const float* channel, int width_px, int height_px);

/// The same levels of max(C_max − C̄, C̄ − C_min), C the padded image's values whose mean C̄ a pixel holds: the most that
/// one of them is off it.
std::vector<ImageLevel> coarse_deviations(const float* channel, int width_px, int height_px,
                                          const std::vector<ImageLevel>& means);

/// The finest level at which a support of `span_px` pixels of level 0 spans at most `pixels_per_support`; 0 where that
/// is 0, and no coarser than `coarsest`.
int level_of_detail(double pixels_per_support, double span_px, int coarsest);

}  // namespace lumifield
