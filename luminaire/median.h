#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace lumifield {

/// The value in the middle, of an even number the upper of the two. `values` is not empty. Reentrant.
template <class T>
T median_of(std::vector<T> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

}  // namespace lumifield
