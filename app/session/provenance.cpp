#include "app/session/provenance.h"

#include <chrono>
#include <cmath>
#include <ctime>
#include <nlohmann/json.hpp>

namespace lumifield {

namespace {

using Json = nlohmann::ordered_json;

void add_end(Json& json, const ScanSummary& summary) {
  json["ended"] = utc_now();
  json["camera"] = summary.camera;
  json["stage"] = summary.stage;
  const ScanTiming& t = summary.timing;
  json["timing_s"] = {{"total", t.total_s},       {"move", t.move_s},       {"settle", t.settle_s},
                      {"exposure", t.exposure_s}, {"readout", t.readout_s}, {"waiting", t.waiting_s},
                      {"other", t.other_s},       {"paused", t.paused_s},   {"lost", t.lost_s}};
  json["frames_retaken"] = summary.frames_retaken;
  json["cameras_lost"] = summary.cameras_lost;
}

Json json_of(const std::vector<ReferenceReading>& readings) {
  Json json = Json::array();
  for (const ReferenceReading& reading : readings) {
    json.push_back({{"cells_done", reading.cells_done},
                    {"signal_dn_per_s", reading.signal_dn_per_s},
                    {"exposure_s", reading.exposure_s},
                    {"drift", reading.drift}});
    if (const auto& end = reading.stabilised)
      json.back()["stabilisation"] = {{"watched_s", end->watched_s}, {"spread", end->spread}, {"steady", end->steady}};
    if (reading.pass != 0) json.back()["pass"] = reading.pass;
  }
  return json;
}

}  // namespace

std::string utc_now() {
  const std::time_t now = std::chrono::system_clock::to_time_t(std::chrono::system_clock::now());
  std::tm utc{};
  gmtime_r(&now, &utc);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &utc);
  return text;
}

std::string provenance_json(const std::string& earlier, const ScanRequest& request, const std::string& started_utc,
                            const std::vector<ReferenceReading>& readings, const ScanSummary* ended) {
  Json json;
  json["program"] = "lumifield " LUMIFIELD_VERSION;
  json["started"] = started_utc;
  if (ended) add_end(json, *ended);
  json["reference"] = json_of(readings);
  json["bench"] = Json::parse(to_json(request.bench));
  json["plan"] = Json::parse(to_json(request.plan));

  Json provenance = Json::parse(earlier, nullptr, false);
  if (!provenance.is_object()) provenance = Json::object();
  Json& scans = provenance["scans"];
  // What another program keeps there stays, in front.
  if (!scans.is_array()) scans = scans.is_null() ? Json::array() : Json::array({scans});
  scans.push_back(std::move(json));
  return provenance.dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::optional<RecordedDrift> largest_drift(const std::string& provenance_json) {
  const Json provenance = Json::parse(provenance_json, nullptr, false);
  std::optional<RecordedDrift> largest;
  try {
    for (const Json& scan : provenance.at("scans"))
      for (const Json& reading : scan.at("reference")) {
        const double drift = reading.at("drift").get<double>();
        if (!largest || std::abs(drift) > std::abs(largest->drift))
          largest = {drift, scan.at("plan").at("reference_cell").at("limit").get<double>()};
      }
  } catch (const Json::exception&) {
    return std::nullopt;  // another program's
  }
  return largest;
}

}  // namespace lumifield
