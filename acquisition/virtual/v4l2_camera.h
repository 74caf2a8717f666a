#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <set>
#include <string>

#include "acquisition/virtual/sight.h"
#include "luminaire/error.h"

namespace lumifield::virtual_bench {

struct V4l2CameraOptions {
  std::filesystem::path folder;  ///< where its file video0 is mounted
  std::string serial = "LF0001";
  std::string pixel_format = "Mono12";  ///< the sensor's: "Mono12" | "Mono16" | "BayerRG12"
  int width_px = 1024, height_px = 768;
  double frame_interval_s = 1.0 / 60;
  int late_frames = 0;          ///< so many frames are held back, and stamped when they leave, as USB cameras do
  int slow_controls = 0;        ///< frames after which what was set acts
  bool clips_exposure = false;  ///< keeps its frame interval, exposes no longer, and does not say so
  int damaged_every = 0, lost_every = 0;  ///< each so many frames
  std::set<std::uint32_t> formats;        ///< FourCC, these alone; empty: all
  std::set<std::uint32_t> stubborn;       ///< controls that do not take what they are set to
  std::set<std::uint32_t> missing;        ///< controls that it does not have
  bool is_for_screens = false;            ///< says that its pictures are in sRGB
};

/// A V4L2 camera on a file of this machine (FUSE), with controls for exposure (100 µs), gain (0.1 dB) and all that a
/// camera out of its box does by itself: exposure, gain, white balance, gamma 2.2, backlight compensation, power-line
/// filter. While one of them is on, the DN are others than those that the sight gives. Formats: those of
/// v4l2_sensor_formats.
///
/// It runs free: frame after frame, of the stage position and the controls at the frame's start, whether anybody takes
/// it or not; a frame takes the longer of frame interval and exposure. A frame during which the stage moved is all
/// white: it is no picture of a place. So is stage_mm() of the sight asked all the time, also in motion.
class V4l2Camera final : public CameraServer {
 public:
  /// Errors: no FUSE here, pixel format unknown.
  static Result<std::unique_ptr<V4l2Camera>> start(const V4l2CameraOptions& options, Sight sight);
  ~V4l2Camera() override;

  std::filesystem::path path() const;
  void freeze(bool frozen) override;
  std::uint64_t frames_sent() const override;
  /// What a control is set to.
  int control(std::uint32_t id) const;

 private:
  struct Impl;
  explicit V4l2Camera(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace lumifield::virtual_bench
