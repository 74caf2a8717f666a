#pragma once

#include <string>

#include "luminaire/geometry.h"

namespace lumifield {

/// Numbers as error messages say them: so many digits, no trailing zeros. Reentrant.
std::string say(double value, int digits = 6);
/// "(x, y)".
std::string say(const Vec2& point);

}  // namespace lumifield
