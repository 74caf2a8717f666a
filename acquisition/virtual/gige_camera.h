#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "acquisition/virtual/genicam_sensor.h"
#include "luminaire/error.h"

namespace lumifield::virtual_bench {

struct GigeCameraOptions {
  std::string address = "127.0.0.1";  ///< of a network interface of this machine
  double lost_packet_ratio = 0;       ///< share of stream packets that are not sent, 0…1
  GenicamOptions genicam = {};
};

/// A GigE Vision camera (GVCP on port 3956, GVSP) on one address of this machine: Aravis' simulator with our GenICam
/// description and a GenicamSensor. The exposure is emulated by releasing the simulator's own trigger late, within a
/// millisecond, so that GVCP is answered meanwhile. freeze() is thread-safe; destroying it takes up to 0.1 s.
class GigeCamera final : public CameraServer {
 public:
  /// Errors: address held by another program, address of no interface here, pixel format unknown, serial too long.
  static Result<std::unique_ptr<GigeCamera>> start(const GigeCameraOptions& options, Sight sight);
  ~GigeCamera() override;

  /// Frozen: triggers are taken and no frame follows.
  void freeze(bool frozen) override;

  std::uint64_t frames_sent() const override;

 private:
  struct Impl;
  explicit GigeCamera(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace lumifield::virtual_bench
