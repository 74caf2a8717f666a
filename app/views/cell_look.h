#pragma once

#include "app/views/histogram_view.h"
#include "app/views/value_scale.h"
#include "luminaire/light_field.h"

namespace lumifield {

/// How a cell's image is shown.
struct CellLook {
  /// Where the scale ends: at the image's own largest value, or at the largest of all cells measured. It starts at 0;
  /// the logarithmic one reaches four decades down from the image's own largest.
  enum class Range { own, common, logarithmic };
  int channel = 0;
  bool grey = false;
  Range range = Range::own;
};

/// From the largest values of the channel in the image and in all cells; an image without positive values ends at 1.
ValueScale scale_of(const CellLook& look, double own_largest, double common_largest);

/// How often values of a channel fall into 128 bins between its least (at most 0) and its largest.
Histogram histogram_of(const CellImage& image, int channel, const QString& unit);

}  // namespace lumifield
