#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>

#include "acquisition/virtual/gige_camera.h"
#include "acquisition/virtual/grbl_controller.h"
#include "acquisition/virtual/knobs.h"
#include "acquisition/virtual/usb_bus.h"
#include "acquisition/virtual/v4l2_camera.h"
#include "acquisition/virtual/world.h"

namespace lumifield::virtual_bench {

/// Which devices a virtual bench has, and what they are told.
struct DeviceOptions {
  WorldOptions world;
  GigeCameraOptions camera;
  V4l2CameraOptions video;
  GrblOptions stage;
  std::string camera_kind = "gige";  ///< "gige" | "usb3" | "v4l2"
  std::string stage_kind = "grbl";   ///< "grbl" | "apt" | "apt-rack" | "apt-servo-rack"

  bool has_usb() const { return camera_kind == "usb3" || stage_kind != "grbl"; }
};

/// The world goes last: stage and camera look into it.
struct Devices {
  std::unique_ptr<World> world;
  std::unique_ptr<UsbBus> usb;  ///< where the camera or the stage is on USB
  std::unique_ptr<StageServer> stage;
  std::unique_ptr<CameraServer> camera;  ///< null while it is switched off
  std::function<Status(bool off)> switch_camera;
  std::atomic<double> worst_off_mm = 0;  ///< of an exposure since it was last asked for

  /// Where an exposure that begins now is taken.
  Vec2 exposed_at() {
    const double off_mm = stage->off_mm().norm();
    for (double worst = worst_off_mm; off_mm > worst && !worst_off_mm.compare_exchange_weak(worst, off_mm);) continue;
    return stage->true_position_mm();
  }
};

/// Starts world, camera and stage. Returns the bench file's content; files of the devices are in `folder`. Options and
/// devices stay where they are.
Result<Bench> start_devices(DeviceOptions& options, Devices& devices, const std::filesystem::path& folder);

/// The knobs of devices that may not have been made yet.
KnobPanel make_knobs(Devices& bench);

}  // namespace lumifield::virtual_bench
