#include "app/session/precedent.h"

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <string_view>

namespace lumifield {

namespace {

using Json = nlohmann::ordered_json;

/// What may change between two scans of one dataset: where devices are found, how fast and how patiently they work,
/// what is allowed and what is worth a warning.
constexpr std::array<std::string_view, 26> free_members = {
    "/camera/address",
    "/camera/readout_s",
    "/camera/packet_bytes",
    "/camera/packet_delay_us",
    "/stage/path",
    "/stage/apt/serials/",
    "/stage/rapid_mm_s",
    "/stage/acceleration_mm_s2",
    "/stage/home",
    "/stage/approach_mm/",
    "/stage/check_home",
    "/limits_mm/",
    "/tolerance_mm",
    "/sensor/responsivity/date",
    "/sensor/responsivity/source",
    "/exposure_limits_s/",
    "/order",
    "/settle_s",
    "/dark_every_cells",
    "/reference_cell/every",
    "/reference_cell/limit",
    "/warm_up_s",
    "/stabilisation",
    "/stabilisation/",
    "/limits/",
    "/name",
};

bool is_free(std::string_view pointer) {
  return pointer.ends_with("/name") ||
         std::any_of(free_members.begin(), free_members.end(), [&](std::string_view free) {
           return free.back() == '/' ? pointer.starts_with(free) : pointer == free;
         });
}

/// "/filter/passes/0/scale" → "filter.passes[0].scale"
std::string key_of(std::string_view pointer) {
  std::string key;
  while (!pointer.empty()) {
    pointer.remove_prefix(1);
    const std::string_view part = pointer.substr(0, pointer.find('/'));
    const bool index = !part.empty() && part.find_first_not_of("0123456789") == part.npos;
    if (index)
      key.append("[").append(part).append("]");
    else
      key.append(key.empty() ? "" : ".").append(part);
    pointer.remove_prefix(part.size());
  }
  return key;
}

std::string text_of(const Json& members, const std::string& pointer) {
  return members.contains(pointer) ? members[pointer].dump(-1, ' ', false, Json::error_handler_t::replace) : "absent";
}

/// What bench and plan were begun with, and what else there is to do.
struct Begun {
  const char* what;
  const char* otherwise;
};
constexpr Begun dataset = {"the dataset", "scan into a new dataset"};
constexpr Begun recording = {"the recording", "record into another folder"};

Status check_same(const Json& recorded, const Json& now, const std::string& place, const Begun& begun = dataset) {
  const Json before = recorded.flatten(), after = now.flatten();
  for (const Json* side : {&after, &before})
    for (const auto& [pointer, value] : side->items())
      if (!is_free(pointer) &&
          !(before.contains(pointer) && after.contains(pointer) && before[pointer] == after[pointer]))
        return fail(
            "is " + text_of(after, pointer) + ", but " + begun.what + " was begun with " + text_of(before, pointer),
            place + ": " + key_of(pointer),
            std::string("resume with the bench and the plan it was begun with, or ") + begun.otherwise);
  return {};
}

Json scans_of(const std::string& provenance_json) {
  const Json provenance = Json::parse(provenance_json, nullptr, false);
  if (!provenance.is_object() || !provenance.contains("scans") || !provenance["scans"].is_array()) return Json::array();
  return provenance["scans"];
}

/// A record with what could not be said in it yet, as its reader takes it; one that does not read stays as it is.
template <class Parse>
Json as_read(const Json& record, Parse parse) {
  const auto read = parse(record.dump(-1, ' ', false, Json::error_handler_t::replace));
  return read ? Json::parse(to_json(*read)) : record;
}

bool has_number(const Json& json, const char* key) { return json.contains(key) && json[key].is_number(); }

}  // namespace

Result<std::string> check_same_measurement(const std::string& provenance_json, const Bench& bench, const Plan& plan) {
  const Json scans = scans_of(provenance_json);
  const Json last = scans.empty() ? Json::object() : scans.back();
  for (const char* part : {"bench", "plan"})
    if (!last.is_object() || !last.contains(part) || !last[part].is_object() || last[part].empty())
      return "the dataset does not tell with which bench and plan it was begun: they are taken to be these";
  const Json bench_then = as_read(last["bench"], [](const std::string& text) { return parse_bench(text, "bench"); });
  const Json plan_then = as_read(last["plan"], [](const std::string& text) { return parse_plan(text, "plan"); });
  if (Status same = check_same(bench_then, Json::parse(to_json(bench)), "bench"); !same)
    return tl::unexpected(same.error());
  if (Status same = check_same(plan_then, Json::parse(to_json(plan)), "plan"); !same)
    return tl::unexpected(same.error());
  return "";
}

Status check_same_bench(const Bench& recorded, const Bench& bench) {
  return check_same(Json::parse(to_json(recorded)), Json::parse(to_json(bench)), "bench", recording);
}

std::optional<ReferenceReading> first_reading(const std::string& provenance_json, int pass) {
  for (const Json& scan : scans_of(provenance_json)) {
    if (!scan.is_object() || !scan.contains("reference") || !scan["reference"].is_array()) continue;
    for (const Json& json : scan["reference"]) {
      if (!json.is_object() || !has_number(json, "signal_dn_per_s") || !has_number(json, "exposure_s")) continue;
      if ((has_number(json, "pass") ? json["pass"].get<int>() : 0) != pass) continue;
      ReferenceReading reading;
      reading.pass = pass;
      reading.signal_dn_per_s = json["signal_dn_per_s"].get<double>();
      reading.exposure_s = json["exposure_s"].get<double>();
      if (reading.signal_dn_per_s > 0 && reading.exposure_s > 0) return reading;
    }
  }
  return std::nullopt;
}

}  // namespace lumifield
