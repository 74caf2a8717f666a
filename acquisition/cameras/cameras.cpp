#include "acquisition/camera.h"
#include "acquisition/cameras/aravis_camera.h"
#include "acquisition/cameras/aravis_discovery.h"
#include "acquisition/cameras/gvcp_probe.h"
#include "acquisition/cameras/replay_camera.h"
#include "acquisition/cameras/v4l2_camera.h"

namespace lumifield {
namespace {

struct CameraKind {
  std::string_view name, of;  ///< as a bench file names it, and what that is
  Result<std::unique_ptr<Camera>> (*open)(const CameraSettings&);
  std::vector<DeviceReport> (*find)();
  DeviceReport (*probe)(const CameraSettings&);
  std::string_view (*when_frames_break)(const CameraInfo&);  ///< what to do
};

constexpr std::string_view usb_advice =
    "take other devices off its bus, take another cable or port, or choose a smaller picture";

std::string_view network_or_usb_advice(const CameraInfo& info) {
  if (!is_ipv4_address(info.address)) return usb_advice;
  return "let sockets hold a frame (net.core.rmem_max, see docs/endurance.md), give the camera a network card of its "
         "own, or make packet_bytes smaller";
}

// A new kind is a file beside this one and a line here.
constexpr CameraKind kinds[] = {
    {"aravis", "GigE Vision and USB3 Vision", open_aravis_camera, find_aravis_cameras, probe_aravis_camera,
     network_or_usb_advice},
    {"v4l2", "Linux video devices", open_v4l2_camera, find_v4l2_cameras, probe_v4l2_camera,
     [](const CameraInfo&) { return usb_advice; }},
    {"replay", "a folder of frames", open_replay_camera, find_replay_cameras, probe_replay_camera,
     [](const CameraInfo&) { return std::string_view("copy the folder anew"); }},
};

Result<CameraKind> kind_of(const CameraSettings& settings) {
  std::string names;
  for (const CameraKind& kind : kinds) {
    if (kind.name == settings.kind) return kind;
    names.append(names.empty() ? "" : ", ").append(kind.name).append(" (").append(kind.of).append(")");
  }
  return fail("unknown kind of camera \"" + settings.kind + "\"", "camera.kind", "known kinds: " + names);
}

}  // namespace

Result<std::unique_ptr<Camera>> open_camera(const CameraSettings& settings) {
  const Result<CameraKind> kind = kind_of(settings);
  if (!kind) return tl::unexpected(kind.error());
  return kind->open(settings);
}

Status check_camera_kind(const CameraSettings& settings) {
  const Result<CameraKind> kind = kind_of(settings);
  return kind ? Status() : tl::unexpected(kind.error());
}

Status check_picture(const CameraInfo& camera, const CameraModel& model) {
  if (camera.sensor_width_px == model.width_px && camera.sensor_height_px == model.height_px) return {};
  const auto size = [](int width, int height) { return std::to_string(width) + "x" + std::to_string(height); };
  return fail(
      "gives pictures of " + size(camera.sensor_width_px, camera.sensor_height_px) +
          " px, but the bench's camera_model is of " + size(model.width_px, model.height_px),
      "camera " + camera.address,
      "check that it is the right camera, its binning and size in the bench file, or calibrate it at this size");
}

DeviceReport probe_camera(const CameraSettings& settings) {
  const Result<CameraKind> kind = kind_of(settings);
  if (!kind) return {"camera", {}, settings.address, false, kind.error().what, kind.error().remedy};
  DeviceReport report = kind->probe(settings);
  report.kind = kind->name;
  return report;
}

DeviceReport try_camera(const Bench& bench, int frames, double exposure_s) {
  const CameraSettings& settings = bench.camera;
  const auto unusable = [&](const Error& error) {
    return DeviceReport{"camera", {}, settings.address, false, error.what, error.remedy};
  };
  const Result<CameraKind> kind = kind_of(settings);
  if (!kind) return unusable(kind.error());
  const auto camera = kind->open(settings);
  if (!camera) return unusable(camera.error());
  if (const Status fits = check_picture((*camera)->info(), bench.camera_model); !fits) return unusable(fits.error());
  for (int k = 0; k < frames; ++k)
    if (const auto image = (*camera)->expose(exposure_s); !image) return unusable(image.error());
  const CameraInfo& info = (*camera)->info();
  DeviceReport report{"camera", info.vendor + " " + info.model + " " + info.serial, info.address, true, {}, {}};
  const int broken = (*camera)->frames_retaken();
  report.reason = std::to_string(frames) + " frames came, none broken";
  if (broken == 0) return report;
  report.reason = std::to_string(broken) + " of " + std::to_string(frames + broken) +
                  " frames came broken, so that packets are lost; they are taken again";
  report.remedy = kind->when_frames_break(info);
  return report;
}

std::vector<DeviceReport> find_cameras() {
  std::vector<DeviceReport> reports;
  for (const CameraKind& kind : kinds)
    for (DeviceReport& report : kind.find()) {
      report.kind = kind.name;
      reports.push_back(std::move(report));
    }
  return reports;
}

}  // namespace lumifield
