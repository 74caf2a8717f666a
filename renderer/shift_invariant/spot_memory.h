#pragma once

#include <cstddef>

#include "luminaire/light_field.h"
#include "renderer/shift_invariant/spot_settings.h"

namespace lumifield {

/// What a picture by shift-invariant takes beside the cells and what every method has, bytes: what OpenGL keeps
/// counts, since in software that is the host's memory. Value type.
struct SpotMemory {
  double images = 0;              ///< the cells' images as a texture
  double maps = 0;                ///< depth maps of a placement, one a cell; 0 without shadows
  std::size_t each_receiver = 0;  ///< its textures, its place in the sums, and what hands them over
};
/// A pure function.
SpotMemory spot_memory(const LuminaireGeometry& geometry, const SpotSettings& settings, bool shadows, bool glossy);

}  // namespace lumifield
