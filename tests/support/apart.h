#pragma once

#include <cmath>
#include <cstddef>
#include <gtest/gtest.h>

#include "renderer/picture.h"

namespace lumifield::test {

/// RMS of the difference over the RMS of `exact`, which is not dark.
inline double apart(const Picture& a, const Picture& exact) {
  double squares = 0, all = 0;
  for (std::size_t k = 0; k < exact.rgb.size(); ++k) {
    squares += std::pow(a.rgb[k] - exact.rgb[k], 2);
    all += std::pow(exact.rgb[k], 2);
  }
  EXPECT_GT(all, 0);
  return std::sqrt(squares / all);
}

}  // namespace lumifield::test
