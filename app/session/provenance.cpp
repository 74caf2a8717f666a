#include "app/session/provenance.h"

#include <chrono>
#include <ctime>
#include <nlohmann/json.hpp>

namespace lumifield {

std::string utc_now() {
  const std::time_t now = std::chrono::system_clock::to_time_t(std::chrono::system_clock::now());
  std::tm utc{};
  gmtime_r(&now, &utc);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &utc);
  return text;
}

std::string provenance_json(const std::string& earlier, const ScanRequest& request, const ScanSummary& summary,
                            const std::string& started_utc) {
  nlohmann::ordered_json json;
  json["program"] = "lumifield " LUMIFIELD_VERSION;
  json["started"] = started_utc;
  json["ended"] = utc_now();
  json["camera"] = summary.camera;
  json["stage"] = summary.stage;
  const ScanTiming& t = summary.timing;
  json["timing_s"] = {{"total", t.total_s},       {"move", t.move_s},       {"settle", t.settle_s},
                      {"exposure", t.exposure_s}, {"readout", t.readout_s}, {"waiting", t.waiting_s},
                      {"other", t.other_s}};
  json["frames_retaken"] = summary.frames_retaken;
  json["reference"] = nlohmann::ordered_json::array();
  for (const ReferenceReading& reading : summary.references)
    json["reference"].push_back(
        {{"cells_done", reading.cells_done}, {"signal_dn_per_s", reading.signal_dn_per_s}, {"drift", reading.drift}});
  json["bench"] = nlohmann::ordered_json::parse(to_json(request.bench));
  json["plan"] = nlohmann::ordered_json::parse(to_json(request.plan));

  nlohmann::ordered_json provenance = nlohmann::ordered_json::parse(earlier);
  nlohmann::ordered_json scans = nlohmann::ordered_json::array();
  if (provenance.contains("scans") && provenance["scans"].is_array())
    for (auto& scan : provenance["scans"])
      if (!scan.is_object() || scan.value("started", "") != started_utc) scans.push_back(std::move(scan));
  scans.push_back(std::move(json));
  provenance["scans"] = std::move(scans);
  return provenance.dump();
}

}  // namespace lumifield
