#pragma once

#include <filesystem>

#include "acquisition/virtual/world.h"

namespace lumifield::virtual_bench {

/// Reads a table of points, CSV with a header that names x_mm, y_mm, z_mm, nx, ny, nz in any order and maybe more, and
/// writes it with the columns E_Y, E_R, E_G, E_B added (W/m², 9 significant digits). Normals must be unit vectors.
/// Errors name the line: a column missing, a field too many or too few, not a number, a normal that is not a unit
/// vector.
Status write_truth(const WorldOptions& options, bool projected, const std::filesystem::path& points,
                   const std::filesystem::path& out);

}  // namespace lumifield::virtual_bench
