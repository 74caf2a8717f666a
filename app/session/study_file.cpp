#include "app/session/study_file.h"

#include <array>
#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>
#include <utility>

#include "luminaire/file_io.h"
#include "luminaire/json_reader.h"

namespace lumifield {

namespace {

using Json = nlohmann::ordered_json;

constexpr std::string_view format = "lumifield-study";
constexpr int version = 1;
constexpr std::size_t most_rows = 10'000, longest_name = 200, longest_look = 40, longest_reason = 4'000;
constexpr int largest_picture = 16'384;
constexpr std::array<std::string_view, 3> outcomes{"ok", "refused", "failed"};

Json result(double value) { return std::isfinite(value) ? Json(value) : Json(); }

std::string fitted(std::string_view text, std::size_t longest) {
  constexpr std::string_view mark = "…";
  const std::string json = Json(std::string(text)).dump(-1, ' ', false, Json::error_handler_t::replace);
  auto valid = Json::parse(json).get<std::string>();
  if (valid.size() <= longest) return valid;
  std::size_t end = longest - mark.size();
  const auto continues = [&](std::size_t k) { return (static_cast<unsigned char>(valid[k]) & 0xC0U) == 0x80U; };
  while (end > 0 && continues(end)) --end;
  return valid.substr(0, end).append(mark);
}

Json json_of(const StudyPoint& p) {
  return {{"method", to_string(p.method)},
          {"luminaire", study_name(p.luminaire)},
          {"cost", p.cost},
          {"time_ms", result(p.time_ms)},
          {"rel_rmse", result(p.rel_rmse)},
          {"lab_delta_e", result(p.lab_delta_e)},
          {"device", study_name(p.device)},
          {"width_px", p.width_px},
          {"height_px", p.height_px}};
}

Json json_of(const StabilityRow& row) {
  return {{"method", to_string(row.method)},
          {"case", study_name(row.case_name)},
          {"outcome", to_string(row.outcome)},
          {"rel_error", result(row.rel_error)},
          {"reason", fitted(row.reason, longest_reason)}};
}

Json json_of(const FigureRow& row) {
  return {{"figure", study_name(row.figure)}, {"luminaire", study_name(row.luminaire)},
          {"what", study_name(row.what)},     {"quantity", study_name(row.quantity)},
          {"ours", result(row.ours)},         {"paper", result(row.paper)}};
}

Json json_of(const StudyOmission& row) {
  return {{"part", study_name(row.part)}, {"reason", fitted(row.reason, longest_reason)}};
}

template <class Row>
Json list_of(const std::vector<Row>& rows) {
  Json list = Json::array();
  for (const Row& row : rows) list.push_back(json_of(row));
  return list;
}

double read_result(const JsonValue& at, double low) {
  return at.is_null() ? std::nan("") : at.number({low, std::numeric_limits<double>::max()});
}

std::string read_text(const JsonValue& at, std::size_t longest = longest_name) {
  std::string text = at.text();
  if (text.size() > longest) at.refuse("is longer than " + std::to_string(longest) + " bytes", "shorten it");
  return text;
}

Method read_method(const JsonValue& at) {
  std::vector<std::string_view> names;
  for (const MethodInfo& each : methods()) names.push_back(each.name);
  return methods()[at.choice(names)].method;
}

StudyPoint read_point(const JsonValue& at) {
  StudyPoint p;
  p.method = read_method(at["method"]);
  p.luminaire = read_text(at["luminaire"]);
  p.cost = at["cost"].number(not_negative);
  p.time_ms = read_result(at["time_ms"], 0);
  p.rel_rmse = read_result(at["rel_rmse"], 0);
  p.lab_delta_e = read_result(at["lab_delta_e"], 0);
  p.device = read_text(at["device"]);
  p.width_px = at["width_px"].integer(1, largest_picture);
  p.height_px = at["height_px"].integer(1, largest_picture);
  return p;
}

StabilityRow read_stability(const JsonValue& at) {
  StabilityRow row;
  row.method = read_method(at["method"]);
  row.case_name = read_text(at["case"]);
  row.outcome = static_cast<StabilityOutcome>(at["outcome"].choice(outcomes));
  row.rel_error = read_result(at["rel_error"], 0);
  row.reason = read_text(at["reason"], longest_reason);
  return row;
}

FigureRow read_figure(const JsonValue& at) {
  FigureRow row;
  row.figure = read_text(at["figure"]);
  row.luminaire = read_text(at["luminaire"]);
  row.what = read_text(at["what"]);
  row.quantity = read_text(at["quantity"]);
  row.ours = read_result(at["ours"], std::numeric_limits<double>::lowest());
  row.paper = read_result(at["paper"], std::numeric_limits<double>::lowest());
  return row;
}

StudyOmission read_omission(const JsonValue& at) {
  return {read_text(at["part"]), read_text(at["reason"], longest_reason)};
}

/// RFC 4180.
std::string csv_field(const Json& value) {
  if (value.is_null()) return {};
  if (value.is_number_float()) {
    std::array<char, 32> text{};
    const auto [end, wrong] = std::to_chars(text.data(), text.data() + text.size(), value.get<double>());
    return {text.data(), end};
  }
  if (!value.is_string()) return value.dump();
  const auto& text = value.get_ref<const std::string&>();
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted.append(c == '"' ? 2 : 1, c);
  return quoted + "\"";
}

void append_line(std::string& text, const std::vector<std::string>& fields) {
  for (std::size_t k = 0; k < fields.size(); ++k) text.append(k == 0 ? "" : ",").append(fields[k]);
  text += '\n';
}

/// The columns are the members of Row{}.
template <class Row>
std::string csv_of(const std::vector<Row>& rows) {
  std::string text;
  std::vector<std::string> fields;
  const Json names = json_of(Row{});
  for (const auto& [key, value] : names.items()) fields.push_back(key);
  append_line(text, fields);
  for (const Row& row : rows) {
    const Json values = json_of(row);
    fields.clear();
    for (const Json& value : values) fields.push_back(csv_field(value));
    append_line(text, fields);
  }
  return text;
}

}  // namespace

std::string study_name(std::string_view text) { return fitted(text, longest_name); }
std::string study_luminaire_name(std::string_view text) { return fitted(text, longest_name - longest_look); }

std::string study_json(const Study& study) {
  return json_file_text({{"format", format},
                         {"version", version},
                         {"scene", fitted(study.scene, longest_reason)},
                         {"quick", study.quick},
                         {"points", list_of(study.points)},
                         {"stability", list_of(study.stability)},
                         {"figures", list_of(study.figures)},
                         {"omissions", list_of(study.omissions)}});
}

Result<Study> parse_study(std::string_view json, std::string_view name) {
  Result<JsonDocument> document = JsonDocument::parse(json, name);
  if (!document) return tl::unexpected(document.error());
  if (Status known = document->check_format(format, version); !known) return tl::unexpected(known.error());
  const JsonValue root = document->root();
  Study study;
  study.scene = read_text(root["scene"], longest_reason);
  study.quick = root["quick"].flag_or(false);
  for (const JsonValue& each : root["points"].elements(0, most_rows)) study.points.push_back(read_point(each));
  for (const JsonValue& each : root["stability"].elements(0, most_rows))
    study.stability.push_back(read_stability(each));
  for (const JsonValue& each : root["figures"].elements(0, most_rows)) study.figures.push_back(read_figure(each));
  // Studies of before have none.
  if (const JsonValue omissions = root["omissions"]; omissions.present())
    for (const JsonValue& each : omissions.elements(0, most_rows)) study.omissions.push_back(read_omission(each));
  std::set<std::string_view> luminaires;
  for (const StudyPoint& point : study.points) luminaires.insert(point.luminaire);
  if (luminaires.size() > most_study_plots)
    root["points"].refuse("name more than " + std::to_string(most_study_plots) + " luminaires and looks",
                          "split the study");
  if (Status right = document->status(); !right) return tl::unexpected(right.error());
  return study;
}

Result<Study> read_study(const std::filesystem::path& file) {
  const Result<std::string> text = read_file(file, JsonLimits{}.bytes);
  if (!text) return tl::unexpected(text.error());
  return parse_study(*text, file.string());
}

Status write_study(const Study& study, const std::filesystem::path& folder) {
  const std::string json = study_json(study);
  if (const auto taken = parse_study(json, (folder / study_file_name).string()); !taken)
    return tl::unexpected(taken.error());
  std::error_code wrong;
  std::filesystem::create_directories(folder, wrong);
  if (wrong) return fail("the folder could not be made: " + wrong.message(), folder.string(), "name another folder");
  const std::array<std::pair<std::string_view, std::string>, 4> files{{{study_file_name, json},
                                                                       {"points.csv", csv_of(study.points)},
                                                                       {"stability.csv", csv_of(study.stability)},
                                                                       {"figures.csv", csv_of(study.figures)}}};
  for (const auto& [name, text] : files)
    if (Status written = write_file_durably(folder / name, text); !written) return written;
  return {};
}

}  // namespace lumifield
