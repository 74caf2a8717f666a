#pragma once

#include <exception>
#include <string>

namespace lumifield {

/// What the OpenEXR library says of a failure, as a clause: without its name for a file in memory, "(string)", and
/// without full stops at its end.
std::string exr_reason(const std::exception& thrown);

}  // namespace lumifield
