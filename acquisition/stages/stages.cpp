#include <filesystem>
#include <set>

#include "acquisition/stage.h"
#include "acquisition/stages/grbl_stage.h"
#include "acquisition/stages/replay_stage.h"

namespace lumifield {
namespace {

struct StageKind {
  std::string_view name;
  Result<std::unique_ptr<Stage>> (*open)(const StageSettings&);
  Result<std::string> (*identify)(const std::string& path);
  bool is_serial;  ///< stands behind a serial port
};

// A new kind is a file beside this one and a line here.
constexpr StageKind kinds[] = {
    {"grbl", open_grbl_stage, identify_grbl_stage, true},
    {"replay", open_replay_stage, identify_replay_stage, false},
};

std::set<std::string> serial_ports() {
  std::set<std::string> ports;
  std::error_code fault;
  for (const auto& entry : std::filesystem::directory_iterator("/dev", fault)) {
    const std::string name = entry.path().filename();
    if (name.starts_with("ttyUSB") || name.starts_with("ttyACM")) ports.insert(entry.path());
  }
  return ports;
}

DeviceReport try_port(const std::string& port) {
  DeviceReport report{.role = "stage", .name = {}, .address = port, .usable = false, .reason = {}, .remedy = {}};
  for (const StageKind& kind : kinds) {
    if (!kind.is_serial) continue;
    const Result<std::string> name = kind.identify(port);
    if (name) return {"stage", *name, port, true, {}, {}};
    report.reason = name.error().what;
    report.remedy = name.error().remedy;
  }
  return report;
}

Result<StageKind> kind_of(const StageSettings& settings) {
  std::string names;
  for (const StageKind& kind : kinds) {
    if (kind.name == settings.kind) return kind;
    names.append(names.empty() ? "" : ", ").append(kind.name);
  }
  return fail("unknown kind of stage \"" + settings.kind + "\"", "stage.kind", "known kinds: " + names);
}

}  // namespace

Result<Vec2> Stage::slipped_mm(std::stop_token) {
  return fail("has no home switches that can be looked for", info().path,
              "set \"check_home\" to false in the bench file");
}

Result<std::unique_ptr<Stage>> open_stage(const StageSettings& settings) {
  const Result<StageKind> kind = kind_of(settings);
  if (!kind) return tl::unexpected(kind.error());
  return kind->open(settings);
}

DeviceReport probe_stage(const StageSettings& settings) {
  const Result<StageKind> kind = kind_of(settings);
  const Result<std::string> name = kind ? kind->identify(settings.path) : tl::unexpected(kind.error());
  if (!name) return {"stage", {}, settings.path, false, name.error().what, name.error().remedy};
  return {"stage", *name, settings.path, true, {}, {}};
}

std::vector<DeviceReport> find_stages(const std::string& path) {
  std::set<std::string> ports = serial_ports();
  if (!path.empty()) ports.insert(path);
  std::vector<DeviceReport> reports;
  for (const std::string& port : ports) reports.push_back(try_port(port));
  return reports;
}

}  // namespace lumifield
