#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "acquisition/virtual/usb_bus.h"
#include "luminaire/error.h"

namespace lumifield::virtual_bench {

/// An FT232 on the virtual USB bus: what its driver asks, and the bytes of its serial line, which the device behind it
/// takes and sends. Bytes go out at once, or empty packets after the latency time, as the chip's.
///
/// Unplugged and plugged in as a UsbDevice is. Thread-safe. Sources: FTDI AN232B-04 (packets of 64 bytes that begin
/// with two of status), libftdi1 (requests).
class FtdiChip {
 public:
  using Bytes = std::vector<std::uint8_t>;

  /// `wake` is called when the host has sent something; it may not call the chip.
  /// Errors: umockdev refuses it.
  static Result<std::unique_ptr<FtdiChip>> plug(UsbBus& bus, std::string product, std::string serial,
                                                std::function<void()> wake);
  ~FtdiChip();

  Status plug();
  void unplug();

  /// What the host has sent since.
  Bytes take();
  /// To the host; lost while it is unplugged.
  void send(const Bytes& bytes);
  /// Gives away what waits longer than the latency time; call it every millisecond. True: a host waits.
  bool tick();

 private:
  struct Impl;
  explicit FtdiChip(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace lumifield::virtual_bench
