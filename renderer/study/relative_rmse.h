#pragma once

#include <cstddef>

#include "renderer/picture.h"

namespace lumifield {

/// The error that a study tells: the root of the mean squared error over the mean of the reference, value by value.
/// Value type.
class RelativeRmse {
 public:
  void add(double value, double reference);
  /// NaN before anything is added.
  double value() const;

 private:
  double squares_ = 0, sum_ = 0;
  std::size_t count_ = 0;
};

/// Of the values of all pixels that the reference, a picture of the same size, covers.
double relative_rmse(const Picture& picture, const Picture& reference);

}  // namespace lumifield
