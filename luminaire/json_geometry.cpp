#include "luminaire/json_geometry.h"

#include <nlohmann/json.hpp>

namespace lumifield {

void check_grid(const JsonValue& at, int columns, int rows) {
  if (static_cast<long long>(columns) * rows > most_cells)
    at.refuse("is a grid of " + std::to_string(static_cast<long long>(columns) * rows) + " cells",
              "at most " + std::to_string(most_cells) + " are allowed");
}

void check_image(const JsonValue& at, const Measurement& measurement, std::size_t channels) {
  if (static_cast<double>(measurement.width_px) * measurement.height_px * static_cast<double>(channels) >
      most_values_per_image)
    at.refuse("is an image of " + std::to_string(measurement.width_px) + " x " + std::to_string(measurement.height_px) +
                  " pixels and " + std::to_string(channels) + " channels",
              "make it smaller: at most 67108864 values are allowed");
}

Measurement read_measurement(const JsonValue& at, const Vec2* center_or) {
  Measurement m;
  m.width_px = at["width_px"].integer(1, most_pixels_per_axis);
  m.height_px = at["height_px"].integer(1, most_pixels_per_axis);
  m.pixel_mm = at["pixel_mm"].vec2(positive);
  m.center_mm = center_or ? at["center_mm"].vec2_or(*center_or) : at["center_mm"].vec2();
  return m;
}

nlohmann::ordered_json to_json_array(const Vec2& v) { return nlohmann::ordered_json::array({v.x(), v.y()}); }

nlohmann::ordered_json to_json_object(const Measurement& measurement) {
  nlohmann::ordered_json json;
  json["width_px"] = measurement.width_px;
  json["height_px"] = measurement.height_px;
  json["pixel_mm"] = to_json_array(measurement.pixel_mm);
  json["center_mm"] = to_json_array(measurement.center_mm);
  return json;
}

}  // namespace lumifield
