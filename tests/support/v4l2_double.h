#pragma once

#include <atomic>
#include <filesystem>
#include <gtest/gtest.h>
#include <string>
#include <unistd.h>

#include "acquisition/virtual/v4l2_camera.h"
#include "luminaire/bench.h"

namespace lumifield {

/// A virtual V4L2 camera whose photosites tell exposure, gain, the stage's x and their place.
class V4l2Double {
 public:
  static constexpr int width = 64, height = 48;

  explicit V4l2Double(virtual_bench::V4l2CameraOptions options = {}) : options_(std::move(options)) {
    options_.folder = std::filesystem::temp_directory_path() / ("lumifield-video-" + std::to_string(getpid()));
    options_.width_px = width, options_.height_px = height;
    options_.serial = "D1";
    if (options_.frame_interval_s > 0.01) options_.frame_interval_s = 0.01;
    plug();
  }

  /// Why there can be no such camera on this machine; empty where there can.
  static std::string why_not() {
    static const std::string why = [] {
      const V4l2Double trial;
      return trial.failure_;
    }();
    return why;
  }

  void plug() {
    auto server = virtual_bench::V4l2Camera::start(
        options_, {.stage_mm = [this] { return Vec2(x, 0); },
                   .wait_ready = [](const Vec2&) {},
                   .expose =
                       [this](const virtual_bench::Exposure& e, std::span<std::uint16_t> out) {
                         for (std::size_t i = 0; i < out.size(); ++i)
                           out[i] = dn(i, e.exposure_s, e.gain_db, static_cast<int>(e.stage_mm.x()), bits());
                       }});
    failure_ = server ? "" : server.error().message();
    if (server) server_ = std::move(*server);
  }
  void unplug() { server_.reset(); }

  virtual_bench::V4l2Camera& server() { return *server_; }
  std::string path() const { return options_.folder / "video0"; }
  int bits() const { return options_.pixel_format == "Mono16" ? 16 : 12; }
  CameraSettings settings(const std::string& format = "Mono12") const {
    CameraSettings settings;
    settings.kind = "v4l2";
    settings.address = path();
    settings.pixel_format = format;
    settings.readout_s = 0;
    return settings;
  }

  static std::uint16_t dn(std::size_t i, double exposure_s, double gain_db, int x, int bits) {
    const long units = std::lround(exposure_s * 1e4), tenths = std::lround(gain_db * 10);
    return static_cast<std::uint16_t>((static_cast<long>(i) * 3 + units * 31 + tenths * 17 + x * 101) &
                                      ((1 << bits) - 1));
  }

  std::atomic<int> x = 0;

 private:
  virtual_bench::V4l2CameraOptions options_;
  std::unique_ptr<virtual_bench::V4l2Camera> server_;
  std::string failure_;
};

/// Photosites that are not as they must be, `dropped` low bits left out.
inline int wrong_photosites(const RawImage& image, double exposure_s, double gain_db, int x, int bits,
                            int dropped = 0) {
  int wrong = image.dn.size() != std::size_t(V4l2Double::width) * V4l2Double::height;
  for (std::size_t i = 0; i < image.dn.size(); ++i)
    wrong += image.dn[i] != V4l2Double::dn(i, exposure_s, gain_db, x, bits) >> dropped;
  return wrong;
}

}  // namespace lumifield
