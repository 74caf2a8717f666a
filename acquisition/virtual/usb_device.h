#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "acquisition/virtual/usb_bus.h"
#include "luminaire/error.h"

namespace lumifield::virtual_bench {

/// What the kernel tells of a device.
struct UsbDescription {
  std::uint16_t vendor = 0, product = 0, release = 0;
  std::string serial;
  int speed_mbit_s = 0;
  std::string descriptors;                     ///< device's, configuration's and those that belong to it, hexadecimal
  std::map<std::uint8_t, unsigned> endpoints;  ///< of bulk transfers, and the interface of each
  std::string kernel_driver = {};              ///< has it until it is detached; empty: none
};

/// What a device does behind its plug. Called with the device's lock held: none of these may call the device.
class UsbFunction {
 public:
  using Clock = std::chrono::steady_clock;

  virtual ~UsbFunction() = default;
  virtual void power_up() = 0;
  /// Answers a control request: its setup packet, and room for the answer behind it. The answer's length, or an errno
  /// less than 0.
  virtual int control(std::uint8_t* setup) = 0;
  /// What the host sends.
  virtual void take(std::uint8_t endpoint, std::span<const std::uint8_t> bytes) = 0;
  /// Fills a request for bytes, the oldest of its endpoint: how many. Nothing: it waits.
  virtual std::optional<std::size_t> give(std::uint8_t endpoint, std::span<std::uint8_t> room,
                                          Clock::time_point asked) = 0;
};

/// A device on the virtual USB bus, as usbfs has it: requests (URB) and their ends.
///
///     plugged in ── unplug ──▶ gone: every request is answered ENODEV, and nobody finds it ── plug ──▶ plugged in, as
///     a new device with the same serial number
///
/// One program claims an interface; another's claim is answered EBUSY, and so is any while the kernel's driver has it,
/// until that is detached. Programs are told of plugging in and out (uevents). Thread-safe. Sources: Linux usbdevfs;
/// USB 3.2 chapter 9.
class UsbDevice {
 public:
  /// Not yet plugged in. `function` outlives it.
  UsbDevice(UsbBus& bus, UsbDescription description, UsbFunction& function);
  ~UsbDevice();

  /// Nothing when it is in. Errors: umockdev refuses it.
  Status plug();
  void unplug();
  bool is_plugged() const;

  /// Lets the function fill what waits; to be called when it may have something. True: a host waits still.
  bool give();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Answers a request for a string descriptor with that of `strings`, counted from 1.
int tell_usb_string(std::span<const std::string> strings, std::uint8_t* setup);
/// Whether a setup packet is such a request.
bool asks_for_usb_string(const std::uint8_t* setup);

}  // namespace lumifield::virtual_bench
