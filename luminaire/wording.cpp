#include "luminaire/wording.h"

#include <array>
#include <cstdio>

namespace lumifield {

std::string say(double value, int digits) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.*g", digits, value + 0.0);  // + 0.0: no "-0"
  return text.data();
}

std::string say(const Vec2& point) {
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "(%.6g, %.6g)", point.x() + 0.0, point.y() + 0.0);
  return text.data();
}

}  // namespace lumifield
