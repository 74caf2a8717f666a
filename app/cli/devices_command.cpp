#include <cstdio>
#include <nlohmann/json.hpp>

#include "acquisition/camera.h"
#include "acquisition/stage.h"
#include "app/cli/commands.h"
#include "renderer/renderer.h"

namespace lumifield {

namespace {

DeviceReport report_of(const std::string& role, const Result<std::string>& probed) {
  if (probed) return {role, *probed, "", true, "", ""};
  return {role, "", probed.error().where, false, probed.error().what, probed.error().remedy};
}

}  // namespace

int run_devices(const DevicesOptions& options) {
  std::vector<DeviceReport> reports{report_of("opencl", probe_opencl()), report_of("opengl", probe_opengl())};
  for (auto& found : {find_cameras(), find_stages(options.stage_path)})
    reports.insert(reports.end(), found.begin(), found.end());

  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const DeviceReport& r : reports) {
    list.push_back({{"role", r.role},
                    {"name", r.name},
                    {"address", r.address},
                    {"usable", r.usable},
                    {"reason", r.reason},
                    {"remedy", r.remedy}});
    if (options.json) continue;
    std::printf("%-7s %-11s %s%s%s\n", r.role.c_str(), r.usable ? "usable" : "not usable", r.name.c_str(),
                r.name.empty() || r.address.empty() ? "" : " at ", r.address.c_str());
    if (!r.usable) std::printf("%20s%s; %s\n", "", r.reason.c_str(), r.remedy.c_str());
  }
  if (options.json) std::printf("%s\n", nlohmann::ordered_json{{"devices", list}}.dump().c_str());
  for (const char* role : {"camera", "stage"})
    if (!options.json &&
        std::none_of(reports.begin(), reports.end(), [&](const DeviceReport& r) { return r.role == role; }))
      std::printf("%-7s none found; connect one and give it power%s\n", role,
                  role == std::string("stage") ? ", or name its port with --stage" : "");
  return exit_done;
}

}  // namespace lumifield
