#include "renderer/bands.h"

#include <system_error>
#include <thread>

namespace lumifield {

namespace {

/// Below this a second thread costs more than it saves.
constexpr std::size_t least_shared = 1 << 15;

}  // namespace

void in_bands(std::size_t count, const std::function<void(std::size_t begin, std::size_t end)>& body) {
  if (count < least_shared || std::thread::hardware_concurrency() < 2) return body(0, count);
  const std::size_t half = count / 2;
  std::jthread other;
  try {
    other = std::jthread([&] { body(half, count); });
  } catch (const std::system_error&) {  // no thread to be had
    return body(0, count);
  }
  body(0, half);
}

}  // namespace lumifield
