#pragma once

#include <cstdint>
#include <mutex>
#include <span>
#include <string>
#include <vector>

#include "acquisition/virtual/genicam_sensor.h"

namespace lumifield::virtual_bench {

/// The address space of a USB3 Vision camera, and its control channel, which reads and writes it: bootstrap registers
/// (ABRM, SBRM, SIRM), the manifest with the GenICam description, and the registers that this names. Thread-safe.
/// Sources: EMVA GenICam GenCP 1.2 and AIA USB3 Vision 1.0, by the names, addresses and codes of Aravis' headers.
class Usb3Memory final : public RegisterMemory {
 public:
  explicit Usb3Memory(const GenicamOptions& options);

  void power_up();
  /// Of what the description names.
  void read(std::uint32_t address, std::span<std::uint8_t> bytes) const override;
  void write(std::uint32_t address, std::span<const std::uint8_t> bytes) override;

  /// The acknowledgement of a command; empty: it is none, or asks for none.
  std::vector<std::uint8_t> answer(std::span<const std::uint8_t> command);
  /// Whether a command writes to a register of the description.
  static bool writes(std::uint32_t address, std::span<const std::uint8_t> command);

  /// How many streams the host has set up.
  std::uint64_t streams() const;
  bool stream_enabled() const;
  /// How the host wants so many bytes of a frame cut into transfers; those that it has no room for are left out.
  std::vector<std::size_t> transfers(std::size_t frame_bytes) const;

 private:
  std::span<std::uint8_t> find(std::uint64_t address, std::size_t count);
  std::uint16_t write_host(std::uint64_t address, std::span<const std::uint8_t> bytes);
  void set_little(std::uint32_t address, std::uint64_t value, int bytes);
  std::uint64_t little(std::uint32_t address, int bytes) const;

  const std::string serial_;
  const GenicamPixelFormat format_;
  const std::string description_;
  mutable std::mutex mutex_;  // guards what follows
  std::vector<std::uint8_t> bootstrap_, registers_, file_;
  std::uint64_t streams_ = 0;
};

}  // namespace lumifield::virtual_bench
