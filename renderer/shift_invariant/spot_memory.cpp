#include "renderer/shift_invariant/spot_memory.h"

#include <algorithm>
#include <cstdint>

#include "renderer/shift_invariant/spot_images.h"

namespace lumifield {

SpotMemory spot_memory(const LuminaireGeometry& geometry, const SpotSettings& settings, bool shadows, bool glossy) {
  constexpr std::size_t four = 4 * sizeof(float), six = 6 * sizeof(double);
  const bool weighted = settings.look_up == SpotLookUp::weighted, coded = settings.sums == SpotSums::srgbe;
  const std::size_t images = glossy ? 2 : 1;
  SpotMemory memory;
  // Position and normal, the face, eye and colour of the lobe.
  memory.each_receiver = four * (2 + (shadows ? 1 : 0) + (glossy ? 2 : 0));
  // In double, on both sides.
  if (weighted) memory.each_receiver += 2 * six;
  // Of sRGBE before and after a pass.
  memory.each_receiver += images * (coded ? 2 * sizeof(std::uint32_t) : four);
  // Its number in the order of texels, and one list in that order while it is handed over.
  memory.each_receiver += sizeof(std::uint32_t) + (weighted ? six : four);
  const auto cells = static_cast<double>(geometry.sampling.cells());
  if (shadows) memory.maps = cells * settings.shadow_map_px * settings.shadow_map_px * sizeof(float);
  const SpotLayout layer(geometry.measurement.width_px, geometry.measurement.height_px, !weighted);
  memory.images = cells * layer.width_px * layer.height_px * (geometry.channels.size() == 3 ? four : sizeof(float));
  return memory;
}

}  // namespace lumifield
