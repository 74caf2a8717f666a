#pragma once

#include <atomic>
#include <cstddef>
#include <functional>
#include <optional>

namespace lumifield {

/// Calls body(begin, end) for bands that together are 0 … count − 1: one on the calling thread and, where there is
/// enough work, one on another. The body writes only what belongs to its band and throws nothing. Reentrant.
void in_bands(std::size_t count, const std::function<void(std::size_t begin, std::size_t end)>& body);

/// The least k below `count` that is(k) holds of, looked for in bands. `is` throws nothing. Reentrant.
template <class Is>
std::optional<std::size_t> first_where(std::size_t count, const Is& is) {
  std::atomic<std::size_t> first = count;
  in_bands(count, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      if (!is(k)) continue;
      for (std::size_t least = first; k < least && !first.compare_exchange_weak(least, k);) continue;
      return;
    }
  });
  return first < count ? std::optional<std::size_t>(first) : std::nullopt;
}

}  // namespace lumifield
