#pragma once

#include "luminaire/light_field.h"

namespace lumifield {

/// Refuses a preview whose cells, kept as float32 for changes of view, would take more than half of `memory_bytes`.
Status check_preview_memory(const LuminaireGeometry& geometry, double memory_bytes);

}  // namespace lumifield
