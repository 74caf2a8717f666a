#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "acquisition/virtual/genicam_sensor.h"
#include "acquisition/virtual/usb_bus.h"
#include "luminaire/error.h"

namespace lumifield::virtual_bench {

/// A USB3 Vision camera on the virtual USB bus: a GenicamSensor, with our GenICam description, behind a control
/// interface and a streaming one. Each frame is a leader, its bytes as the host wants them cut, and a trailer.
///
/// It has its power from the bus: plugged in again it is as new, without a stream. It keeps up to three frames that
/// nobody fetches; more are lost. Thread-safe; destroying it unplugs it, and ends programs that have it open.
/// Sources: those of Usb3Memory; USB 3.2 chapter 9.
class Usb3Camera final : public CameraServer {
 public:
  struct Options {
    GenicamOptions genicam = {};
    int cut_every = 0;                   ///< each so many frames comes short
    bool loses_trigger_answers = false;  ///< every other one, so that the host triggers again
  };
  /// Errors: pixel format unknown, serial empty or too long, those of the bus.
  static Result<std::unique_ptr<Usb3Camera>> start(UsbBus& bus, const Options& options, Sight sight);
  ~Usb3Camera() override;

  Status plug();
  void unplug();
  /// Frozen: triggers are taken and no frame follows.
  void freeze(bool frozen) override;
  std::uint64_t frames_sent() const override;

 private:
  struct Impl;
  explicit Usb3Camera(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace lumifield::virtual_bench
