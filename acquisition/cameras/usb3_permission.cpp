#include "acquisition/cameras/usb3_permission.h"

#include <cerrno>
#include <cstdio>
#include <fstream>
#include <set>
#include <string>
#include <unistd.h>

namespace lumifield {
namespace fs = std::filesystem;
namespace {

/// An attribute's first line, empty where there is none.
std::string attribute(const fs::path& device, const char* name) {
  std::string line;
  std::getline(std::ifstream(device / name), line);
  return line;
}

bool is_usb3_vision(const fs::path& interface) {
  return attribute(interface, "bInterfaceClass") == "ef" && attribute(interface, "bInterfaceSubClass") == "05";
}

/// "001/004" of a device's numbers in sysfs.
std::string node_of(const fs::path& device) {
  int bus = 0, number = 0;
  if (std::sscanf(attribute(device, "busnum").c_str(), "%d", &bus) != 1) return {};
  if (std::sscanf(attribute(device, "devnum").c_str(), "%d", &number) != 1) return {};
  char text[32];
  std::snprintf(text, sizeof text, "%03d/%03d", bus, number);
  return text;
}

}  // namespace

std::vector<DeviceReport> usb3_cameras_without_permission(const fs::path& sysfs, const fs::path& nodes) {
  // An interface "1-2:1.0" is one of the device "1-2".
  std::set<fs::path> devices;
  std::error_code fault;
  for (fs::directory_iterator at(sysfs, fault), end; !fault && at != end; at.increment(fault)) {
    const std::string name = at->path().filename();
    const std::size_t colon = name.find(':');
    if (colon != std::string::npos && is_usb3_vision(at->path())) devices.insert(sysfs / name.substr(0, colon));
  }

  std::vector<DeviceReport> reports;
  for (const fs::path& device : devices) {
    const std::string node = node_of(device);
    if (node.empty() || eaccess((nodes / node).c_str(), R_OK | W_OK) == 0 || errno != EACCES) continue;
    const std::string name =
        attribute(device, "manufacturer") + " " + attribute(device, "product") + " " + attribute(device, "serial");
    reports.push_back(
        {"camera", name, (nodes / node).string(), false, "no permission to open it",
         "install the rules for devices on USB with `scripts/setup --udev`, and add yourself to the group "
         "plugdev"});
  }
  return reports;
}

}  // namespace lumifield
