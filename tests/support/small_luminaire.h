#pragma once

#include "renderer/study/synthetic_luminaire.h"

namespace lumifield::test {

/// Four by three cells of 70×70 pixels, supports of 32 mm, planes 60 mm apart: what every method computes at once.
inline SyntheticLuminaire small_luminaire() {
  return {.name = "small",
          .separation_mm = 60,
          .spacing_mm = 16,
          .columns = 4,
          .rows = 3,
          .pixels = 70,
          .pixel_mm = 1,
          .lobes = 8,
          .spread_mm = 30,
          .least_width_mm = 2,
          .greatest_width_mm = 12};
}

}  // namespace lumifield::test
