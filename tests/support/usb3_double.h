#pragma once

#include <atomic>
#include <chrono>
#include <cmath>
#include <gtest/gtest.h>
#include <memory>
#include <string>
#include <thread>

#include "acquisition/virtual/usb3_camera.h"
#include "luminaire/bench.h"
#include "luminaire/raw_image.h"
#include "tests/support/usb_bus.h"

namespace lumifield {

/// A virtual USB3 Vision camera, on this program's own bus, whose photosites tell exposure, gain, the stage's x and
/// their place.
class Usb3Double {
 public:
  using Options = virtual_bench::Usb3Camera::Options;

  explicit Usb3Double(Options options = {.genicam = {.serial = "D1", .width_px = 64, .height_px = 48}})
      : options_(options) {
    auto server = virtual_bench::Usb3Camera::start(
        test::usb_bus(), options,
        {.stage_mm = [this] { return Vec2(x, 0); },
         .wait_ready = [this](const Vec2&) { std::this_thread::sleep_for(std::chrono::milliseconds(ready_after_ms)); },
         .expose =
             [this](const virtual_bench::Exposure& e, std::span<std::uint16_t> out) {
               for (std::size_t i = 0; i < out.size(); ++i)
                 out[i] = dn(i, e.exposure_s, e.gain_db, static_cast<int>(e.stage_mm.x()), bits());
             }});
    EXPECT_TRUE(server) << server.error().message();
    server_ = std::move(*server);
  }

  virtual_bench::Usb3Camera& server() { return *server_; }
  int bits() const { return virtual_bench::genicam_pixel_format(options_.genicam.pixel_format).value().bits; }
  CameraSettings settings() const {
    CameraSettings settings;
    settings.kind = "aravis";
    settings.address = options_.genicam.serial;
    settings.pixel_format = options_.genicam.pixel_format;
    settings.readout_s = 0.1;
    return settings;
  }

  static std::uint16_t dn(std::size_t i, double exposure_s, double gain_db, int x, int bits) {
    const long us = std::lround(exposure_s * 1e6), tenths = std::lround(gain_db * 10);
    return static_cast<std::uint16_t>((static_cast<long>(i) * 3 + us * 31 + tenths * 17 + x * 101) & ((1 << bits) - 1));
  }
  /// Photosites that are not as they must be.
  int wrong(const RawImage& image, double exposure_s, double gain_db) const {
    const auto& sensor = options_.genicam;
    int wrong = image.dn.size() != std::size_t(sensor.width_px) * std::size_t(sensor.height_px);
    for (std::size_t i = 0; i < image.dn.size(); ++i) wrong += image.dn[i] != dn(i, exposure_s, gain_db, x, bits());
    return wrong;
  }

  std::atomic<int> x = 0, ready_after_ms = 0;

 private:
  Options options_;
  std::unique_ptr<virtual_bench::Usb3Camera> server_;
};

}  // namespace lumifield
