#include "acquisition/camera.h"
#include "acquisition/cameras/aravis_camera.h"
#include "acquisition/cameras/aravis_discovery.h"
#include "acquisition/cameras/replay_camera.h"
#include "acquisition/cameras/v4l2_camera.h"

namespace lumifield {
namespace {

struct CameraKind {
  std::string_view name;
  Result<std::unique_ptr<Camera>> (*open)(const CameraSettings&);
  std::vector<DeviceReport> (*find)();
  DeviceReport (*probe)(const CameraSettings&);
};

// A new kind is a file beside this one and a line here.
constexpr CameraKind kinds[] = {
    {"aravis", open_aravis_camera, find_aravis_cameras, probe_aravis_camera},
    {"v4l2", open_v4l2_camera, find_v4l2_cameras, probe_v4l2_camera},
    {"replay", open_replay_camera, find_replay_cameras, probe_replay_camera},
};

Result<CameraKind> kind_of(const CameraSettings& settings) {
  std::string names;
  for (const CameraKind& kind : kinds) {
    if (kind.name == settings.kind) return kind;
    names.append(names.empty() ? "" : ", ").append(kind.name);
  }
  return fail("unknown kind of camera \"" + settings.kind + "\"", "camera.kind", "known kinds: " + names);
}

}  // namespace

Result<std::unique_ptr<Camera>> open_camera(const CameraSettings& settings) {
  const Result<CameraKind> kind = kind_of(settings);
  if (!kind) return tl::unexpected(kind.error());
  return kind->open(settings);
}

DeviceReport probe_camera(const CameraSettings& settings) {
  const Result<CameraKind> kind = kind_of(settings);
  if (!kind) return {"camera", {}, settings.address, false, kind.error().what, kind.error().remedy};
  return kind->probe(settings);
}

std::vector<DeviceReport> find_cameras() {
  std::vector<DeviceReport> reports;
  for (const CameraKind& kind : kinds)
    for (DeviceReport& report : kind.find()) reports.push_back(std::move(report));
  return reports;
}

}  // namespace lumifield
