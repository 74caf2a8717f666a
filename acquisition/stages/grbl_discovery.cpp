#include <filesystem>
#include <set>

#include "acquisition/stages/grbl_dialogue.h"
#include "acquisition/stages/grbl_stage.h"

namespace lumifield {
namespace {

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
  const Result<GrblFound> found = GrblDialogue::listen(port);
  if (!found) return {"stage", {}, port, false, found.error().what, found.error().remedy};
  return {"stage", found->name, port, true, {}, {}, found->capabilities};
}

}  // namespace

std::vector<DeviceReport> find_grbl_stages(const std::string& path) {
  std::set<std::string> ports = serial_ports();
  if (!path.empty()) ports.insert(path);
  std::vector<DeviceReport> reports;
  for (const std::string& port : ports) reports.push_back(try_port(port));
  return reports;
}

DeviceReport probe_grbl_stage(const StageSettings& settings) { return try_port(settings.path); }

}  // namespace lumifield
