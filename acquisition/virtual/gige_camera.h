#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string>

#include "luminaire/error.h"
#include "luminaire/geometry.h"

namespace lumifield::virtual_bench {

/// One exposure as the camera was set when its trigger came. The region is in sensor pixels.
struct Exposure {
  Vec2 stage_mm{0, 0};
  double exposure_s = 0, gain_db = 0;
  int width_px = 0, height_px = 0, offset_x_px = 0, offset_y_px = 0;
};

/// What the camera sees. `stage_mm` and `wait_ready` are called on the exposure thread, `expose` on the server thread.
struct Sight {
  std::function<Vec2()> stage_mm;
  std::function<void(const Vec2& stage_mm)> wait_ready;
  std::function<void(const Exposure&, std::span<std::uint16_t> dn)>
      expose;  ///< any region, may reach beyond the sensor
};

struct GigeCameraOptions {
  std::string address = "127.0.0.1";    ///< of a network interface of this machine
  std::string serial = "LF0001";        ///< at most 15 characters
  std::string pixel_format = "Mono12";  ///< the one the sensor delivers: "Mono12" | "Mono16" | "BayerRG12"
  int width_px = 1024, height_px = 768;
  double lost_packet_ratio = 0;  ///< share of stream packets that are not sent, 0…1
};

/// A GigE Vision camera (GVCP on port 3956, GVSP) on one address of this machine: Aravis' simulator with our GenICam
/// description. Features: Width, Height, OffsetX, OffsetY (even), PixelFormat, ExposureTime (µs), Gain (dB),
/// TriggerMode, TriggerSource = Software, TriggerSoftware.
///
///     armed ── TriggerSoftware ──▶ exposing ── exposure time over and image computed ──▶ read out ──▶ armed
///
/// The stage position, exposure time and gain of a frame are those at the start of the exposure; a trigger during an
/// exposure is ignored (TriggerOverlap Off), one during readout is kept. With TriggerMode Off exposures follow each
/// other without a pause. The exposure is emulated by releasing the simulator's own trigger late, within a millisecond,
/// so that GVCP is answered meanwhile. An exposure ends without a frame when its acquisition or its stream does. freeze() is thread-safe; destroying it takes up to 0.1 s.
class GigeCamera {
 public:
  /// Errors: address held by another program, address of no interface here, pixel format unknown, serial too long.
  static Result<std::unique_ptr<GigeCamera>> start(const GigeCameraOptions& options, Sight sight);
  ~GigeCamera();

  /// Frozen: triggers are taken and no frame follows.
  void freeze(bool frozen);

  std::uint64_t frames_sent() const;

 private:
  struct Impl;
  explicit GigeCamera(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace lumifield::virtual_bench
