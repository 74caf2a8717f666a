#pragma once

#include <cstdint>
#include <functional>
#include <span>

#include "luminaire/geometry.h"

namespace lumifield::virtual_bench {

/// One exposure as the camera was set when it began. The region is in sensor pixels.
struct Exposure {
  Vec2 stage_mm{0, 0};
  double exposure_s = 0, gain_db = 0;
  int width_px = 0, height_px = 0, offset_x_px = 0, offset_y_px = 0;
};

/// What a camera sees. `stage_mm` and `wait_ready` are called on its exposure thread, `expose` on that which gives the
/// pixels away.
struct Sight {
  std::function<Vec2()> stage_mm;
  std::function<void(const Vec2& stage_mm)> wait_ready;
  std::function<void(const Exposure&, std::span<std::uint16_t> dn)>
      expose;  ///< any region, may reach beyond the sensor
};

/// A simulated camera on a real transport; destroying it unplugs it. Both functions are thread-safe.
class CameraServer {
 public:
  virtual ~CameraServer() = default;

  /// Frozen: it answers, and no frame comes.
  virtual void freeze(bool frozen) = 0;
  virtual std::uint64_t frames_sent() const = 0;
};

}  // namespace lumifield::virtual_bench
