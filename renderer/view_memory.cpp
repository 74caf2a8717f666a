#include "renderer/view_memory.h"

#include <cstdio>
#include <string>

namespace lumifield {

Status check_view_memory(std::string_view what, std::size_t pixels, std::size_t luminaires, std::size_t each_bytes,
                         double memory_bytes) {
  const double bytes = static_cast<double>(pixels) * static_cast<double>(luminaires) * static_cast<double>(each_bytes);
  if (bytes <= memory_bytes / 2) return {};
  char text[160];
  std::snprintf(text, sizeof text,
                "%zu pixels seen by %zu luminaires take %.3g GB, more than the %.3g GB that they may", pixels,
                luminaires, bytes / 1e9, memory_bytes / 2e9);
  return fail(text, std::string(what), "make a smaller picture, or place fewer luminaires");
}

}  // namespace lumifield
