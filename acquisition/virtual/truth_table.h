#pragma once

#include <filesystem>

#include "acquisition/virtual/world.h"

namespace lumifield::virtual_bench {

/// Reads a table of points, CSV whose header begins x_mm,y_mm,z_mm,nx,ny,nz, and writes it with the columns E_Y, E_R,
/// E_G, E_B added (W/m², 9 significant digits). Normals must be unit vectors. Errors name the line.
Status write_truth(const WorldOptions& options, bool projected, const std::filesystem::path& points,
                   const std::filesystem::path& out, const TruthGrid& grid = {});

}  // namespace lumifield::virtual_bench
