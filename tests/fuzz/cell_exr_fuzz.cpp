#include <cmath>
#include <cstdint>
#include <cstdlib>

#include "luminaire/cell_exr.h"

/// The image of an EXR file that is read is finite and of the luminaire's size.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace lumifield;
  static const LuminaireGeometry geometry = [] {
    LuminaireGeometry g;
    g.planes.separation_mm = 150;
    g.sampling = {BasisKind::bell, {7.5, 7.5}, 9, 7, {0, 0}};
    g.measurement = {5, 4, {1, 1}, {0, 0}};
    g.channels = {"R", "G", "B"};
    return g;
  }();
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  const auto cell = decode_cell_exr(bytes, geometry, "cell");
  if (!cell) return 0;
  if (cell->image.value.size() != 60) std::abort();
  for (const float value : cell->image.value)
    if (!std::isfinite(value)) std::abort();
  return 0;
}
