#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "luminaire/error.h"
#include "luminaire/light_field.h"

namespace lumifield {

/// One cell's image as OpenEXR, internal to this room. The only user of OpenEXR here: its exceptions end in this pair.

/// FLOAT channels named as the luminaire's, and `<channel>.variance` when known; uncompressed, since half the time of
/// storing a cell would go into deflating noise. The header names row, column and generation, and no clock.
Result<std::string> encode_cell_exr(const CellImage& image, const LuminaireGeometry& geometry, CellIndex cell,
                                    int generation);

/// What an EXR file held. The attributes are absent when another program wrote it.
struct CellExr {
  CellImage image;  ///< quality not determined
  std::optional<int> row, column, generation;
};

/// HALF or FLOAT, any compression and channel order, scanlines or tiles. Refuses, naming the place: another size, a
/// data window that is not the display window, a missing channel, variance of some channels only, NaN, Inf, negative
/// variance, and a file that ends early. `where` stands for the file and the cell in messages.
Result<CellExr> decode_cell_exr(std::string_view bytes, const LuminaireGeometry& geometry, std::string_view where);

/// A quality of which nothing is determined.
Quality unknown_quality();

}  // namespace lumifield
