#include "luminaire/plan.h"

#include <nlohmann/json.hpp>

#include "luminaire/file_io.h"
#include "luminaire/json_geometry.h"

namespace lumifield {
namespace {

constexpr std::string_view format = "lumifield-plan";
constexpr int version = 1;
constexpr std::string_view orders[] = {"serpentine", "coarse-to-fine"};

std::vector<double> read_exposures(const JsonValue& at) {
  const std::vector<double> exposures = at.numbers(1, most_exposures, {0, 3600, true});
  for (std::size_t k = 1; k < exposures.size(); ++k)
    if (!(exposures[k] > exposures[k - 1])) at.refuse("does not ascend", "order it from the shortest to the longest");
  return exposures;
}

std::optional<ExposureLimits> read_exposure_limits(const JsonValue& at, const std::vector<double>& exposures_s) {
  if (!at.present()) {
    if (!exposures_s.empty())
      at.note_default(nlohmann::json({exposures_s.front(), exposures_s.back()}).dump() +
                      ", the plan's exposures alone");
    return std::nullopt;
  }
  const std::vector<double> ends = at.numbers(2, 2, {0, 3600, true});
  if (ends.size() != 2) return std::nullopt;
  if (ends[1] < ends[0]) at.refuse("does not ascend", "give the shortest exposure first, then the longest");
  return ExposureLimits{ends[0], ends[1]};
}

std::optional<Stabilisation> read_stabilisation(const JsonValue& at) {
  if (!at.present()) at.note_default("null, the scan does not wait for a steady lamp");
  if (!at.present() || at.is_null()) return std::nullopt;
  Stabilisation s;
  s.within = at["within"].number({0, 1, true});
  s.over_s = at["over_s"].number({shortest_stabilisation_s, longest_stabilisation_s});
  s.limit_s = at["limit_s"].number({0, longest_stabilisation_s});
  if (s.within == 1) at["within"].refuse("is no spread of a steady lamp", "give a share below 1, for example 0.005");
  if (s.limit_s < s.over_s) at["limit_s"].refuse("is shorter than over_s", "allow at least the time that is watched");
  return s;
}

ReferenceCell read_reference(const JsonValue& at, int columns, int rows) {
  ReferenceCell r;
  r.cell.row = at["row"].integer(0, rows - 1);
  r.cell.column = at["column"].integer(0, columns - 1);
  r.every = at["every"].integer_or(r.every, 0, most_cells);
  r.limit = at["limit"].number_or(r.limit, positive);
  return r;
}

QualityLimits read_limits(const JsonValue& at) {
  QualityLimits limits;
  limits.saturated_share = at["saturated_share"].number_or(limits.saturated_share, share);
  limits.median_snr = at["median_snr"].number_or(limits.median_snr, not_negative);
  return limits;
}

}  // namespace

Result<Plan> parse_plan(std::string_view json, std::string_view name, std::vector<std::string>* notes,
                        ReaderNotes kind) {
  Result<JsonDocument> document = JsonDocument::parse(json, name);
  if (!document) return tl::unexpected(document.error());
  document->note_unknown_keys();
  if (Status ok = document->check_format(format, version); !ok) return tl::unexpected(ok.error());
  const JsonValue root = document->root();
  Plan p;
  p.name = root["name"].text_or("");
  p.columns = root["columns"].integer(1, most_cells_per_axis);
  p.rows = root["rows"].integer(1, most_cells_per_axis);
  check_grid(root["columns"], p.columns, p.rows);
  p.center_mm = root["center_mm"].vec2_or(p.center_mm);
  p.order = root["order"].choice_or(0, orders) == 0 ? ScanOrder::serpentine : ScanOrder::coarse_to_fine;
  p.measurement = read_measurement(root["measurement"], &p.measurement.center_mm);
  check_image(root["measurement"], p.measurement, 3);
  p.exposures_s = read_exposures(root["exposures_s"]);
  p.exposure_limits_s = read_exposure_limits(root["exposure_limits_s"], p.exposures_s);
  p.settle_s = root["settle_s"].number_or(p.settle_s, {0, 3600});
  p.dark_every_cells = root["dark_every_cells"].integer_or(p.dark_every_cells, 0, most_cells);
  p.reference = read_reference(root["reference_cell"], p.columns, p.rows);
  p.warm_up_s = root["warm_up_s"].number_or(p.warm_up_s, {0, 1e6});
  p.stabilisation = read_stabilisation(root["stabilisation"]);
  p.limits = read_limits(root["limits"]);
  if (Status ok = document->finish(notes, kind); !ok) return tl::unexpected(ok.error());
  return p;
}

Result<Plan> read_plan(const std::filesystem::path& file, std::vector<std::string>* notes, ReaderNotes kind) {
  const Result<std::string> text = read_file(file, JsonLimits{}.bytes);
  if (!text) return tl::unexpected(text.error());
  return parse_plan(*text, file.string(), notes, kind);
}

std::string to_json(const Plan& p) {
  nlohmann::ordered_json json;
  json["format"] = format;
  json["version"] = version;
  json["name"] = p.name;
  json["columns"] = p.columns;
  json["rows"] = p.rows;
  json["center_mm"] = to_json_array(p.center_mm);
  json["order"] = p.order == ScanOrder::serpentine ? "serpentine" : "coarse-to-fine";
  json["measurement"] = to_json_object(p.measurement);
  json["exposures_s"] = p.exposures_s;
  if (p.exposure_limits_s)
    json["exposure_limits_s"] = {p.exposure_limits_s->shortest_s, p.exposure_limits_s->longest_s};
  else if (!p.exposures_s.empty())
    json["exposure_limits_s"] = {p.exposures_s.front(), p.exposures_s.back()};
  json["settle_s"] = p.settle_s;
  json["dark_every_cells"] = p.dark_every_cells;
  json["reference_cell"] = {{"row", p.reference.cell.row},
                            {"column", p.reference.cell.column},
                            {"every", p.reference.every},
                            {"limit", p.reference.limit}};
  json["warm_up_s"] = p.warm_up_s;
  json["stabilisation"] = nullptr;
  if (const auto& s = p.stabilisation)
    json["stabilisation"] = {{"within", s->within}, {"over_s", s->over_s}, {"limit_s", s->limit_s}};
  json["limits"] = {{"saturated_share", p.limits.saturated_share}, {"median_snr", p.limits.median_snr}};
  return json_file_text(json);
}

}  // namespace lumifield
