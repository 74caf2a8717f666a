#pragma once

#include <QImage>

namespace lumifield {

/// How values become colours: false colour (renderer/false_colour.h) or grey, linear or logarithmic between two ends.
/// Values beyond an end take its colour, and so do values ≤ 0 on a logarithmic scale; NaN takes a grey that says
/// nothing and should be hatched. Value type.
struct ValueScale {
  double from = 0, to = 1;
  bool logarithmic = false;  ///< from > 0
  bool grey = false;

  bool operator==(const ValueScale&) const = default;
  /// 0 … 1 between the ends.
  double share(double value) const;
};

/// Colour of a share 0 … 1 of a scale.
QRgb share_colour(double share, bool grey);
inline QRgb colour_of(const ValueScale& scale, double value) { return share_colour(scale.share(value), scale.grey); }

/// Values row by row, first row at the bottom of the image: +y up.
QImage colour_image(const float* values, int width, int height, const ValueScale& scale);

}  // namespace lumifield
