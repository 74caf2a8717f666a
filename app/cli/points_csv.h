#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "luminaire/error.h"
#include "renderer/methods/closed_form.h"

namespace lumifield {

/// Points of `lumifield probe`: a CSV whose first line names the columns x_mm, y_mm, z_mm, nx, ny, nz in any order,
/// luminaire frame; other columns are passed over, and told in `notes`. UTF-8, with or without a byte-order mark, lines
/// that end in LF or CRLF. At most ten million lines. Refuses what is not a finite number and normals that are not of
/// unit length to 1e-3 (they are then normalised exactly), naming line and column.
Result<std::vector<Receiver>> read_points_csv(const std::filesystem::path& file, std::vector<std::string>& notes);

/// The same columns and one E_<channel> each, then one stated_error_<channel> each where these are given; nine
/// significant digits for them, for the points as many as they need. Through a temporary name.
Status write_points_csv(const std::filesystem::path& file, const std::vector<Receiver>& points,
                        const std::vector<std::string>& channels, const std::vector<double>& irradiance,
                        const std::vector<double>& stated_error = {});

}  // namespace lumifield
