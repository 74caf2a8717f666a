#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "luminaire/light_field.h"

namespace lumifield {

/// Which receiver stands in which texel of what the passes of shift-invariant draw to: those alone that a cell may
/// light, in pairs of rows as in the picture, or of a list two by two, so that what is drawn together is near together.
/// A receiver has no texel that is not in front of U, whose normal faces no cell, or that sees the images from none.
/// Value type.
struct SpotOrder {
  static constexpr std::uint32_t none = ~std::uint32_t(0);
  int columns = 0, rows = 0;
  std::vector<std::uint32_t> receiver;  ///< by texel, row by row; none of what fills the last row

  /// p and n as 4 floats each, luminaire frame; `picture_columns` of a picture of them, 0: they are a list. At most
  /// `most_columns` wide.
  SpotOrder(const LuminaireGeometry& geometry, std::span<const float> p_xyzw, std::span<const float> n_xyzw,
            int picture_columns, int most_columns);
  SpotOrder() = default;
};

}  // namespace lumifield
