#include "app/session/preview_memory.h"

#include <cstdio>

namespace lumifield {

Status check_preview_memory(const LuminaireGeometry& geometry, double memory_bytes) {
  const double bytes = static_cast<double>(geometry.sampling.columns) * geometry.sampling.rows *
                       static_cast<double>(geometry.measurement.pixels()) *
                       static_cast<double>(geometry.channels.size()) * sizeof(float);
  if (bytes <= memory_bytes / 2) return {};
  char text[128];
  std::snprintf(text, sizeof text, "its cells take %.1f GB, more than half of this machine's %.1f GB", bytes / 1e9,
                memory_bytes / 1e9);
  return fail(text, "preview", "scan without a preview, or plan fewer cells or pixels");
}

}  // namespace lumifield
