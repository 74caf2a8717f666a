#include "renderer/study/relative_rmse.h"

#include <cmath>

namespace lumifield {

void RelativeRmse::add(double value, double reference) {
  squares_ += (value - reference) * (value - reference);
  sum_ += reference;
  ++count_;
}

double RelativeRmse::value() const {
  const auto n = static_cast<double>(count_);
  return std::sqrt(squares_ / n) / (sum_ / n);
}

double relative_rmse(const Picture& picture, const Picture& reference) {
  RelativeRmse error;
  for (std::size_t k = 0; k < reference.rgb.size(); ++k)
    if (reference.coverage[k / 3] != 0)
      error.add(static_cast<double>(picture.rgb[k]), static_cast<double>(reference.rgb[k]));
  return error.value();
}

}  // namespace lumifield
