#include <nlohmann/json.hpp>

#include "luminaire/json_reader.h"

namespace lumifield {
namespace {

/// Flat inside arrays and where it is short, one member a line otherwise.
void print(const nlohmann::ordered_json& json, std::size_t indent, bool flat, std::string& out) {
  constexpr std::size_t width = 110;
  constexpr auto replace = nlohmann::ordered_json::error_handler_t::replace;
  const std::string line = json.dump(-1, ' ', false, replace);
  if (flat || !json.is_structured() || json.empty() || (indent > 0 && line.size() + indent <= width)) {
    out += line;
    return;
  }
  const std::string pad(indent + 2, ' ');
  out += json.is_array() ? "[" : "{";
  bool first = true;
  for (const auto& [key, value] : json.items()) {
    out += (first ? "\n" : ",\n") + pad;
    first = false;
    if (json.is_object()) out += nlohmann::ordered_json(key).dump(-1, ' ', false, replace) + ": ";
    print(value, indent + 2, json.is_array(), out);
  }
  out.append("\n").append(indent, ' ').append(json.is_array() ? "]" : "}");
}

}  // namespace

std::string json_file_text(const nlohmann::ordered_json& json) {
  std::string text;
  print(json, 0, false, text);
  return text + "\n";
}

}  // namespace lumifield
