#include "luminaire/manifest.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "luminaire/bench.h"
#include "luminaire/dataset.h"
#include "luminaire/file_io.h"
#include "luminaire/json_geometry.h"
#include "luminaire/plan.h"

namespace lumifield {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::string_view format = "lumifield-luminaire";
constexpr int version = 1;
constexpr std::string_view bases[] = {"box", "tent", "bell", "bspline2"};
constexpr BasisKind kinds[] = {BasisKind::box, BasisKind::tent, BasisKind::bell, BasisKind::bspline2};
constexpr std::string_view quantity_names[] = {"radiance", "luminance", "relative"};
constexpr Quantity quantities[] = {Quantity::radiance, Quantity::luminance, Quantity::relative};
constexpr JsonLimits manifest_limits{most_manifest_bytes, 20'000'000, 64};
constexpr JsonLimits line_limits{std::size_t{1} << 20, 20'000, 32};

std::vector<std::string> read_channels(const JsonValue& at) {
  std::vector<std::string> channels;
  for (const JsonValue& each : at.elements(1, 3)) channels.push_back(each.text());
  if (channels != std::vector<std::string>{"Y"} && channels != std::vector<std::string>{"R", "G", "B"})
    at.refuse("is neither [\"Y\"] nor [\"R\", \"G\", \"B\"]", "name the channels so, in this order");
  return channels;
}

Sampling read_sampling(const JsonValue& at) {
  Sampling s;
  s.basis = kinds[at["basis"].choice(bases)];
  s.spacing_mm = at["spacing_mm"].vec2(positive);
  s.columns = at["columns"].integer(1, most_cells_per_axis);
  s.rows = at["rows"].integer(1, most_cells_per_axis);
  check_grid(at, s.columns, s.rows);
  s.center_mm = at["center_mm"].vec2();
  return s;
}

LuminaireGeometry read_geometry(const JsonValue& root) {
  LuminaireGeometry g;
  g.quantity = quantities[root["quantity"].choice(quantity_names)];
  if (root["unit"].text() != unit_of(g.quantity))
    root["unit"].refuse("is not the unit of " + std::string(to_string(g.quantity)),
                        "make it \"" + std::string(unit_of(g.quantity)) + "\"");
  g.channels = read_channels(root["channels"]);
  g.planes.separation_mm = root["planes"]["separation_mm"].number(positive);
  g.sampling = read_sampling(root["sampling"]);
  g.measurement = read_measurement(root["measurement"], nullptr);
  check_image(root["measurement"], g.measurement, g.channels.size());
  return g;
}

/// Absent and null are "not determined".
double read_figure(const JsonValue& at, Range range) {
  return at.present() && !at.is_null() ? at.number(range) : std::numeric_limits<double>::quiet_NaN();
}

Quality read_quality(const JsonValue& at) {
  Quality q;
  q.saturated_share = read_figure(at["saturated_share"], share);
  q.starved_share = read_figure(at["starved_share"], share);
  q.median_snr = read_figure(at["median_snr"], any_number);
  q.position_error_mm = read_figure(at["position_error_mm"], not_negative);
  q.drift = read_figure(at["drift"], any_number);
  q.dark_dn = read_figure(at["dark_dn"], any_number);
  if (at["warnings"].present())
    for (const JsonValue& each : at["warnings"].elements(0, 1000)) q.warnings.push_back(each.text());
  if (const JsonValue exposures = at["exposures_s"]; exposures.present())
    for (const std::string& pass : exposures.keys(most_passes))
      q.exposures_s[pass] = exposures[pass].numbers(1, most_exposures, {0, 3600, true});
  return q;
}

/// Lower-case hex, empty when it is none.
std::string read_sha256(const JsonValue& at) {
  std::string hex = at.text();
  for (char& c : hex)
    if (c >= 'A' && c <= 'F') c = static_cast<char>(c - 'A' + 'a');
  const bool all_hex = hex.find_first_not_of("0123456789abcdef") == std::string::npos;
  if (!hex.empty() && (hex.size() != 64 || !all_hex))
    at.refuse("is no SHA-256", "give 64 hexadecimal digits, or leave it out");
  return hex;
}

CellEntry read_entry(const JsonValue& at, const Sampling& sampling) {
  CellEntry entry;
  entry.cell.row = at["row"].integer(0, sampling.rows - 1);
  entry.cell.column = at["column"].integer(0, sampling.columns - 1);
  entry.file = at["file"].text();
  if (const Status ok = check_relative_path(entry.file, {}); !ok) at["file"].refuse(ok.error().what, ok.error().remedy);
  if (at["generation"].present()) entry.generation = at["generation"].integer(1, 1'000'000'000);
  if (at["sha256"].present()) entry.sha256 = read_sha256(at["sha256"]);
  if (at["stage_mm"].present()) entry.stage_mm = at["stage_mm"].vec2();
  if (at["quality"].present()) entry.quality = read_quality(at["quality"]);
  return entry;
}

/// Numbers that are not finite are written as null.
Json json_of(const Quality& q) {
  Json json = {{"saturated_share", q.saturated_share},
               {"starved_share", q.starved_share},
               {"median_snr", q.median_snr},
               {"position_error_mm", q.position_error_mm},
               {"drift", q.drift},
               {"dark_dn", q.dark_dn},
               {"warnings", q.warnings}};
  if (!q.exposures_s.empty()) json["exposures_s"] = q.exposures_s;
  return json;
}

Json json_of(const CellEntry& entry) {
  Json json = {
      {"row", entry.cell.row}, {"column", entry.cell.column}, {"file", entry.file}, {"generation", entry.generation}};
  if (!entry.sha256.empty()) json["sha256"] = entry.sha256;
  if (entry.stage_mm) json["stage_mm"] = to_json_array(*entry.stage_mm);
  if (entry.quality) json["quality"] = json_of(*entry.quality);
  return json;
}

Json json_of(const LuminaireGeometry& g) {
  Json json;
  json["quantity"] = to_string(g.quantity);
  json["unit"] = unit_of(g.quantity);
  json["channels"] = g.channels;
  json["planes"]["separation_mm"] = g.planes.separation_mm;
  json["sampling"] = {{"basis", to_string(g.sampling.basis)},
                      {"spacing_mm", to_json_array(g.sampling.spacing_mm)},
                      {"columns", g.sampling.columns},
                      {"rows", g.sampling.rows},
                      {"center_mm", to_json_array(g.sampling.center_mm)}};
  json["measurement"] = to_json_object(g.measurement);
  return json;
}

}  // namespace

Result<Manifest> parse_manifest(std::string_view json, std::string_view name, std::vector<std::string>* notes) {
  Result<JsonDocument> document = JsonDocument::parse(json, name, manifest_limits);
  if (!document) return tl::unexpected(document.error());
  if (Status ok = document->check_format(format, version); !ok) return tl::unexpected(ok.error());
  const JsonValue root = document->root();
  Manifest manifest;
  manifest.name = root["name"].text_or("");
  manifest.geometry = read_geometry(root);
  if (Status ok = document->status(); !ok) return tl::unexpected(ok.error());
  for (const JsonValue& each : root["cells"].elements(0, most_cells))
    manifest.cells.push_back(read_entry(each, manifest.geometry.sampling));
  const JsonValue provenance = root["provenance"];
  if (provenance.present()) {
    provenance.keys(100'000);
    manifest.provenance_json = provenance.dump();
  } else {
    provenance.note_default("{}");
  }
  if (Status ok = document->finish(notes); !ok) return tl::unexpected(ok.error());
  return manifest;
}

Result<CellEntry> parse_journal_line(std::string_view line, const LuminaireGeometry& geometry, std::string_view name) {
  Result<JsonDocument> document = JsonDocument::parse(line, name, line_limits);
  if (!document) return tl::unexpected(document.error());
  CellEntry entry = read_entry(document->root(), geometry.sampling);
  if (Status ok = document->status(); !ok) return tl::unexpected(ok.error());
  return entry;
}

std::string to_journal_line(const CellEntry& entry) {
  return json_of(entry).dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string to_json(const Manifest& manifest) {
  Json json;
  json["format"] = format;
  json["version"] = version;
  json["name"] = manifest.name;
  json.update(json_of(manifest.geometry));
  json["cells"] = Json::array();
  for (const CellEntry& entry : manifest.cells) json["cells"].push_back(json_of(entry));
  json["provenance"] = Json::parse(manifest.provenance_json, nullptr, false);
  return json_file_text(json);
}

std::optional<std::string> first_difference(const LuminaireGeometry& a, const LuminaireGeometry& b) {
  const Json left = json_of(a).flatten(), right = json_of(b).flatten();
  for (const auto& [pointer, value] : left.items()) {
    const auto other = right.find(pointer);
    if (other != right.end() && *other == value) continue;
    std::string place = pointer.substr(1);
    std::replace(place.begin(), place.end(), '/', '.');
    return place + " is " + value.dump() + ", not " + (other == right.end() ? "absent" : other->dump());
  }
  return left.size() == right.size() ? std::nullopt : std::optional<std::string>("the channels differ in number");
}

}  // namespace lumifield
