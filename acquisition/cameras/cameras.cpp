#include "acquisition/camera.h"
#include "acquisition/cameras/aravis_camera.h"
#include "acquisition/cameras/aravis_discovery.h"

namespace lumifield {
namespace {

struct CameraKind {
  std::string_view name;
  Result<std::unique_ptr<Camera>> (*open)(const CameraSettings&);
  std::vector<DeviceReport> (*find)();
};

// A new kind is a file beside this one and a line here.
constexpr CameraKind kinds[] = {
    {"aravis", open_aravis_camera, find_aravis_cameras},
};

}  // namespace

Result<std::unique_ptr<Camera>> open_camera(const CameraSettings& settings) {
  std::string names;
  for (const CameraKind& kind : kinds) {
    if (kind.name == settings.kind) return kind.open(settings);
    names.append(names.empty() ? "" : ", ").append(kind.name);
  }
  return fail("unknown kind of camera \"" + settings.kind + "\"", "camera.kind", "known kinds: " + names);
}

std::vector<DeviceReport> find_cameras() {
  std::vector<DeviceReport> reports;
  for (const CameraKind& kind : kinds)
    for (DeviceReport& report : kind.find()) reports.push_back(std::move(report));
  return reports;
}

}  // namespace lumifield
