#include "acquisition/virtual/ftdi_chip.h"

#include <algorithm>
#include <mutex>

#include "acquisition/virtual/ftdi_line.h"
#include "acquisition/virtual/usb_device.h"

namespace lumifield::virtual_bench {
namespace {

constexpr std::size_t packet_bytes = 64;
constexpr std::uint8_t in_endpoint = 0x81, out_endpoint = 0x02;

// Device 0403:faf0, full speed, one interface with one bulk endpoint each way.
constexpr const char* descriptors =
    "12010002000000080304F0FA000601020301"
    "09022000010100A02D0904000002FFFFFF02"
    "07058102400000"
    "07050202400000";

UsbDescription describe(const std::string& serial) {
  return {.vendor = 0x0403,
          .product = 0xfaf0,
          .release = 0x0600,
          .serial = serial,
          .speed_mbit_s = 12,
          .descriptors = descriptors,
          .endpoints = {{in_endpoint, 0}, {out_endpoint, 0}},
          .kernel_driver = "ftdi_sio"};
}

}  // namespace

struct FtdiChip::Impl final : UsbFunction {
  std::function<void()> wake;
  std::mutex mutex;  // of the line; taken after the device's
  FtdiLine line;
  UsbDevice device;  // the last: it uses the others

  Impl(UsbBus& bus, const std::string& product, const std::string& serial, std::function<void()> on_bytes)
      : wake(std::move(on_bytes)), line{product, serial, {}, {}}, device(bus, describe(serial), *this) {}

  void power_up() override {
    const std::lock_guard lock(mutex);
    line = {line.product, line.serial, {}, {}};
  }
  int control(std::uint8_t* setup) override {
    const std::lock_guard lock(mutex);
    return answer_control(line, setup);
  }
  void take(std::uint8_t, std::span<const std::uint8_t> bytes) override {
    {
      const std::lock_guard lock(mutex);
      line.received.insert(line.received.end(), bytes.begin(), bytes.end());
    }
    wake();
  }
  /// Packets of what is to be sent, or one empty packet when the latency time is over.
  std::optional<std::size_t> give(std::uint8_t, std::span<std::uint8_t> room, Clock::time_point asked) override {
    const std::lock_guard lock(mutex);
    if (line.to_send.empty() && Clock::now() < asked + std::chrono::milliseconds(line.latency_ms)) return std::nullopt;
    std::size_t filled = 0;
    do {
      const std::size_t count = std::min({packet_bytes - 2, line.to_send.size(), room.size() - filled - 2});
      std::copy_n(ftdi_status, 2, room.begin() + static_cast<std::ptrdiff_t>(filled));
      const auto end = line.to_send.begin() + static_cast<std::ptrdiff_t>(count);
      std::copy(line.to_send.begin(), end, room.begin() + static_cast<std::ptrdiff_t>(filled) + 2);
      line.to_send.erase(line.to_send.begin(), end);
      filled += count + 2;
    } while (!line.to_send.empty() && filled % packet_bytes == 0 && filled + packet_bytes <= room.size());
    return filled;
  }
};

Result<std::unique_ptr<FtdiChip>> FtdiChip::plug(UsbBus& bus, std::string product, std::string serial,
                                                 std::function<void()> wake) {
  std::unique_ptr<FtdiChip> chip(new FtdiChip(std::make_unique<Impl>(bus, product, serial, std::move(wake))));
  if (Status plugged = chip->plug(); !plugged) return tl::unexpected(plugged.error());
  return chip;
}

FtdiChip::FtdiChip(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
FtdiChip::~FtdiChip() = default;

Status FtdiChip::plug() { return impl_->device.plug(); }
void FtdiChip::unplug() { impl_->device.unplug(); }
FtdiChip::Bytes FtdiChip::take() {
  const std::lock_guard lock(impl_->mutex);
  return std::exchange(impl_->line.received, {});
}
void FtdiChip::send(const Bytes& bytes) {
  if (!impl_->device.is_plugged()) return;
  {
    const std::lock_guard lock(impl_->mutex);
    impl_->line.to_send.insert(impl_->line.to_send.end(), bytes.begin(), bytes.end());
  }
  impl_->device.give();
}
bool FtdiChip::tick() { return impl_->device.give(); }

}  // namespace lumifield::virtual_bench
