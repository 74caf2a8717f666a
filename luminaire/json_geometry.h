#pragma once

#include <nlohmann/json_fwd.hpp>

#include "luminaire/json_reader.h"
#include "luminaire/light_field.h"

namespace lumifield {

/// What bench, plan and manifest spell alike, internal to this room.

/// Limits that hold for every grid and image, checked before memory is taken.
constexpr int most_cells_per_axis = 100'000;
constexpr int most_cells = 1'000'000;
constexpr int most_pixels_per_axis = 16384;
constexpr double most_values_per_image = 67'108'864;  ///< width · height · channels

/// Refuses a grid or an image above the limits.
void check_grid(const JsonValue& at, int columns, int rows);
void check_image(const JsonValue& at, const Measurement& measurement, std::size_t channels);
/// "measurement" of plan and manifest; `center_or` is the default of an optional center_mm.
Measurement read_measurement(const JsonValue& at, const Vec2* center_or);

nlohmann::ordered_json to_json_array(const Vec2& v);
nlohmann::ordered_json to_json_object(const Measurement& measurement);
}  // namespace lumifield
