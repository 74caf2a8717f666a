#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "luminaire/bench.h"
#include "luminaire/error.h"
#include "luminaire/raw_image.h"

namespace lumifield {

struct CameraInfo {
  std::string vendor, model, serial, address;
  int sensor_width_px = 0, sensor_height_px = 0;
  std::string found = {};  ///< settings that were found at opening, as the bench file spells them
};

/// The role of a camera: one complete frame per call, exposed when asked. Thread-bound: opened, used and destroyed by
/// the bench thread. Destroying one may block for seconds after the link was lost.
class Camera {
 public:
  virtual ~Camera() = default;

  virtual const CameraInfo& info() const = 0;

  /// Exposes one frame and waits for it. Only complete frames are returned; an incomplete one is taken again a bounded
  /// number of times and counted. `exposure_s` in the result is what the camera reports.
  /// Errors: no frame within the exposure + 300 ms, camera gone; of ErrorKind::refused what opening it again does not
  /// mend: an exposure outside the camera's range, a frame that a recording does not hold.
  virtual Result<RawImage> expose(double exposure_s) = 0;

  /// Where the stage stands, told before every exposure of a scan. Nothing to a camera that sees what is before it; one
  /// that plays frames back gives those of that place.
  virtual void tell_place(const Vec2& stage_mm) { (void)stage_mm; }

  /// What a frame takes beyond its exposure, about, on the mean over brackets of these, of a camera that runs free; 0
  /// where CameraSettings::readout_s says it.
  virtual double frame_wait_s(std::span<const double> exposures_s) const {
    (void)exposures_s;
    return 0;
  }

  /// Incomplete frames taken again since opening.
  virtual int frames_retaken() const = 0;
};

/// Opens the camera that a bench file names, applies its pixel format, gain, and full region, and verifies what the
/// camera took. Errors: nothing at the address, held by another program, format not offered, kind unknown.
Result<std::unique_ptr<Camera>> open_camera(const CameraSettings& settings);

/// One line of `lumifield devices`.
struct DeviceReport {
  std::string role;  ///< "camera" | "stage"
  std::string name;  ///< vendor model serial
  std::string address;
  bool usable = false;
  std::string reason, remedy;     ///< why not and what to do
  std::string capabilities = {};  ///< in words, of one that is usable: "Mono8, Mono12; 2048x1536 px; …"
  std::string serial = {};        ///< where the device has one
  std::string kind = {};          ///< as a bench file names it
};

/// Every camera that answers, usable or not. Takes about a second (GigE Vision discovery), and opens each for a moment,
/// to ask what it can.
std::vector<DeviceReport> find_cameras();

/// That the kind of camera is known. Pure. Errors: it is not, with those that are.
Status check_camera_kind(const CameraSettings& settings);

/// That the pictures of an open camera have the size of the bench's camera model. Pure.
Status check_picture(const CameraInfo& camera, const CameraModel& model);

/// Opens the camera that a bench file names and takes so many frames. `reason` tells how many came
/// broken, though the camera is usable then: they are taken again.
DeviceReport try_camera(const Bench& bench, int frames, double exposure_s);

/// The camera that a bench file names, answering or not; it is not opened. `address` is as in find_cameras when it
/// answers.
DeviceReport probe_camera(const CameraSettings& settings);

}  // namespace lumifield
