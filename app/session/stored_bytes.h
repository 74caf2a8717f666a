#pragma once

#include "luminaire/light_field.h"

namespace lumifield {

/// What a stored cell takes on disk at most: values and variance in FLOAT. Real ones compress to a half or less.
inline double stored_cell_bytes(const LuminaireGeometry& geometry) {
  return static_cast<double>(geometry.measurement.pixels()) * static_cast<double>(geometry.channels.size()) * 2 *
         sizeof(float);
}

}  // namespace lumifield
