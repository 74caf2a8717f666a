#include "renderer/view_memory.h"

#include <cstdio>
#include <string>

namespace lumifield {

Status check_view_memory(std::string_view what, const ViewMemory& view, double memory_bytes) {
  const double bytes = view.bytes();
  if (bytes <= memory_bytes / 2) return {};
  char text[160];
  std::snprintf(text, sizeof text,
                "%zu pixels seen by %zu luminaires take %.3g GB, more than the %.3g GB that they may", view.pixels,
                view.luminaires, bytes / 1e9, memory_bytes / 2e9);
  return fail(text, std::string(what),
              view.luminaire_bytes > 0 ? "make a smaller picture, place fewer luminaires, or leave shadows out"
                                       : "make a smaller picture, or place fewer luminaires");
}

}  // namespace lumifield
