#pragma once

#include <cstddef>
#include <functional>

namespace lumifield {

/// Calls body(begin, end) for bands that together are 0 … count − 1: one on the calling thread and, where there is
/// enough work, one on another. The body writes only what belongs to its band and throws nothing. Reentrant.
void in_bands(std::size_t count, const std::function<void(std::size_t begin, std::size_t end)>& body);

}  // namespace lumifield
