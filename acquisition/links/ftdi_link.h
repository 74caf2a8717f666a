#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "acquisition/links/link_fault.h"
#include "luminaire/error.h"

struct ftdi_context;

namespace lumifield {

struct UsbId {
  std::uint16_t vendor, product;
};

/// A device seen on USB; one that may not be opened tells its serial to nobody.
struct FtdiDevice {
  std::string serial, product;
  std::optional<Error> closed;  ///< why it cannot be opened
};

/// The serial line of an FTDI chip on USB, carrying bytes: found by its serial number, owned alone, 8 data bits, no
/// parity, one stop bit, RTS/CTS.
///
/// Alone means that the chip's interface is claimed; the kernel's own driver (ftdi_sio) is detached from it. What the
/// far side sends is here after at most 4 ms. After a hang-up every call answers hang_up; open it again.
///
/// Thread-bound, but write(), which is thread-safe.
class FtdiLink {
 public:
  using Milliseconds = std::chrono::milliseconds;

  /// Errors: none with that serial, no permission, in use by another program, speed refused, gone meanwhile.
  static Result<std::unique_ptr<FtdiLink>> open(UsbId id, const std::string& serial, int baud);

  /// All that are plugged in, in use or not. None is claimed.
  static std::vector<FtdiDevice> find(UsbId id);

  ~FtdiLink();
  FtdiLink(const FtdiLink&) = delete;
  FtdiLink& operator=(const FtdiLink&) = delete;

  const std::string& serial() const { return serial_; }

  /// Writes all bytes, never interleaved with those of another thread; 1 s at most.
  LinkResult<void> write(std::span<const std::uint8_t> bytes);

  /// What has come, as soon as there is something.
  LinkResult<std::vector<std::uint8_t>> read(Milliseconds timeout);

 private:
  FtdiLink(ftdi_context* chip, std::string serial) : chip_(chip), serial_(std::move(serial)) {}
  Status configure(int baud);

  ftdi_context* chip_;
  std::string serial_;
  std::mutex writing_;
};

}  // namespace lumifield
