#pragma once

#include <cstddef>
#include <string_view>

#include "luminaire/error.h"

namespace lumifield {

/// Refuses a view whose receivers, one for each pixel and luminaire, take more on the host than half of
/// `memory_bytes`: `each_bytes` for `what` of each. To be asked before any of it is taken. Reentrant.
Status check_view_memory(std::string_view what, std::size_t pixels, std::size_t luminaires, std::size_t each_bytes,
                         double memory_bytes);

}  // namespace lumifield
