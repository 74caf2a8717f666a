#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <optional>

#include "acquisition/camera.h"
#include "acquisition/stage.h"
#include "app/cli/commands.h"
#include "app/cli/print_result.h"
#include "luminaire/bench.h"
#include "renderer/renderer.h"

namespace lumifield {

namespace {

/// A device and, when a bench file names it, that file.
struct Found {
  DeviceReport device;
  std::string bench;
};

DeviceReport report_of(const std::string& role, const Result<std::string>& probed) {
  if (probed) return {role, *probed, "", true, "", ""};
  return {role, "", probed.error().where, false, probed.error().what, probed.error().remedy};
}

/// Marks the device of a bench file among those found, or adds it.
void name_by_bench(std::vector<Found>& found, DeviceReport device, const std::string& bench) {
  const auto same = [&](const Found& f) { return f.device.role == device.role && f.device.address == device.address; };
  const auto at = std::find_if(found.begin(), found.end(), same);
  if (at == found.end()) {
    found.push_back({std::move(device), bench});
    return;
  }
  at->bench = bench;
  at->device.usable = device.usable, at->device.reason = device.reason, at->device.remedy = device.remedy;
  if (!device.capabilities.empty()) at->device.capabilities = device.capabilities;
}

DeviceReport none(const std::string& role) {
  return {role,
          "",
          "",
          false,
          "none found",
          role == "stage" ? "connect one and give it power, or name its port with --stage or in a bench file"
                          : "connect one and give it power, or name its address in a bench file"};
}

std::vector<Found> find_devices(const DevicesOptions& options) {
  std::vector<Found> found{{report_of("opencl", probe_opencl()), ""}, {report_of("opengl", probe_opengl()), ""}};
  const auto bench = options.bench.empty() ? std::optional<Result<Bench>>() : read_bench(options.bench);
  if (bench && !*bench) {
    const Error& error = bench->error();
    found.push_back({{"bench", "", error.where, false, error.what, error.remedy}, ""});
  }
  const bool named = bench && *bench;
  for (DeviceReport& camera : find_cameras()) found.push_back({std::move(camera), ""});
  if (named) {
    const CameraSettings& camera = (*bench)->camera;
    DeviceReport probed = probe_camera(camera);
    if (probed.usable && options.frames > 0) {
      const DeviceReport tried = try_camera(**bench, options.frames, options.exposure_s);
      probed.usable = tried.usable, probed.reason = tried.reason, probed.remedy = tried.remedy;
      if (!tried.usable && tried.reason.starts_with("an exposure of")) probed.remedy += "; --exposure names another";
    }
    name_by_bench(found, std::move(probed), options.bench);
  }
  for (DeviceReport& stage : find_stages(options.stage_path)) found.push_back({std::move(stage), ""});
  if (named) name_by_bench(found, probe_stage((*bench)->stage), options.bench);
  for (const char* role : {"camera", "stage"})
    if (std::none_of(found.begin(), found.end(), [&](const Found& f) { return f.device.role == role; }))
      found.push_back({none(role), ""});
  return found;
}

void print(const Found& found) {
  const DeviceReport& d = found.device;
  const std::string place = d.name.empty() || d.address.empty() ? d.address : " at " + d.address;
  std::printf("%-7s %-11s %s%s%s\n", d.role.c_str(), d.usable ? "usable" : "not usable", d.name.c_str(), place.c_str(),
              found.bench.empty() ? "" : (" (named in " + found.bench + ")").c_str());
  std::string what = d.kind;
  if (!d.serial.empty()) what += ", serial " + d.serial;
  if (!d.capabilities.empty()) what += "; " + d.capabilities;
  if (what != d.kind) std::printf("%20s%s\n", "", what.c_str());
  const std::string remedy = d.remedy.empty() ? "" : "; " + d.remedy;
  if (!d.reason.empty()) std::printf("%20s%s%s\n", "", d.reason.c_str(), remedy.c_str());
}

}  // namespace

int run_devices(const DevicesOptions& options) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  bool unread = false;  // a bench file that was named
  for (const Found& found : find_devices(options)) {
    const DeviceReport& d = found.device;
    unread = unread || d.role == "bench";
    if (!options.json) print(found);
    list.push_back({{"role", d.role},
                    {"name", d.name},
                    {"address", d.address},
                    {"usable", d.usable},
                    {"reason", d.reason},
                    {"remedy", d.remedy},
                    {"bench", found.bench},
                    {"kind", d.kind},
                    {"serial", d.serial},
                    {"capabilities", d.capabilities}});
  }
  if (options.json) std::printf("%s\n", dump_json({{"devices", list}}).c_str());
  return unread ? exit_failed : exit_done;
}

}  // namespace lumifield
