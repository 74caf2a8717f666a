#pragma once

#include <string>

#include "luminaire/geometry.h"

namespace lumifield {

/// Numbers as the scan's error messages say them: six digits, no trailing zeros. Reentrant.
std::string say(double value);
/// "(x, y)".
std::string say(const Vec2& point);

}  // namespace lumifield
