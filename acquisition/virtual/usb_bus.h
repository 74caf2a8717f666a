#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "luminaire/error.h"

typedef struct _UMockdevTestbed UMockdevTestbed;

namespace lumifield::virtual_bench {

/// A USB bus that this program and those started from it see instead of this machine's: a library stands before their
/// system calls (umockdev), and their libusb finds the devices of this process. /sys is the bus's alone; what others
/// look for there, the processors and memories of /sys/devices/system, is linked into it.
///
/// A program whose bus is gone is ended by that library: keep it for as long as such programs run. One per process.
class UsbBus {
 public:
  /// Errors: umockdev's library is missing, or enter() was not called.
  static Result<std::unique_ptr<UsbBus>> create();
  ~UsbBus();
  UsbBus(const UsbBus&) = delete;
  UsbBus& operator=(const UsbBus&) = delete;

  /// Starts this program again before that library, unless it was: to be called first of all. Returns where it was, or
  /// cannot be.
  static void enter(char** argv);
  static bool is_entered();

  UMockdevTestbed* testbed() const { return testbed_; }
  /// Where the programs' /sys and /dev are.
  std::filesystem::path root() const;
  /// For the next device; the kernel counts them, too.
  int next_number() { return ++devices_; }

 private:
  explicit UsbBus(UMockdevTestbed* testbed) : testbed_(testbed) {}

  UMockdevTestbed* testbed_;
  int devices_ = 1;  // the hub
};

}  // namespace lumifield::virtual_bench
