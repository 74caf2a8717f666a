#include "acquisition/virtual/usb3_camera.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <deque>
#include <mutex>
#include <thread>

#include "acquisition/virtual/genicam_registers.h"
#include "acquisition/virtual/usb3_descriptors.h"
#include "acquisition/virtual/usb3_memory.h"
#include "acquisition/virtual/usb_device.h"

namespace lumifield::virtual_bench {
namespace {

using Bytes = std::vector<std::uint8_t>;

constexpr std::size_t most_frames = 3;
constexpr std::uint32_t leader_prefix = 0x4c563355, leader_bytes = 52, image_payload = 1;
constexpr std::uint32_t trailer_prefix = 0x54563355, trailer_bytes = 32;
constexpr std::uint8_t set_endpoint = 0x02, set_feature = 3;  // the one feature is to halt

void put(Bytes& to, std::uint64_t value, int bytes) {
  for (int i = 0; i < bytes; ++i) to.push_back(std::uint8_t(value >> 8 * i));
}

struct FrameHead {
  std::uint64_t number, time_ns;
  std::uint32_t format, width, height, offset_x, offset_y;
};

Bytes leader(const FrameHead& frame) {
  Bytes to;
  put(to, leader_prefix, 4), put(to, 0, 2), put(to, leader_bytes, 2), put(to, frame.number, 8);
  put(to, 0, 2), put(to, image_payload, 2), put(to, frame.time_ns, 8), put(to, frame.format, 4);
  put(to, frame.width, 4), put(to, frame.height, 4), put(to, frame.offset_x, 4), put(to, frame.offset_y, 4);
  put(to, 0, 4);
  return to;
}

Bytes trailer(const FrameHead& frame, std::size_t frame_bytes) {
  Bytes to;
  put(to, trailer_prefix, 4), put(to, 0, 2), put(to, trailer_bytes, 2), put(to, frame.number, 8);
  put(to, 0, 4), put(to, frame_bytes, 8), put(to, frame.height, 4);
  return to;
}

}  // namespace

struct Usb3Camera::Impl final : UsbFunction, FrameLink {
  const Options options;
  Usb3Memory memory;
  GenicamSensor sensor;

  std::mutex mutex;  // guards what follows; taken after the device's
  std::deque<Bytes> answers;
  struct Transfer {
    Bytes bytes;
    std::size_t given = 0;
    bool ends_frame = false;
  };
  std::deque<Transfer> transfers;
  std::size_t frames_kept = 0;
  bool lost_last = false;  // of the answers to triggers
  std::uint64_t next_number = 0, numbered_stream = 0;
  std::atomic<std::uint64_t> frames_sent = 0;

  UsbDevice device;
  std::jthread exposure_thread;  // the last: it uses the others

  Impl(UsbBus& bus, const Options& camera, Sight sight)
      : options(camera),
        memory(camera.genicam),
        sensor(camera.genicam, std::move(sight), memory),
        device(bus, usb3::describe(camera.genicam.serial), *this) {}

  void power_up() override {
    memory.power_up();
    sensor.power_up();
    const std::lock_guard lock(mutex);
    answers.clear();
    drop_frames();
  }
  void drop_frames() { transfers.clear(), frames_kept = 0; }

  int control(std::uint8_t* setup) override {
    if (asks_for_usb_string(setup)) return tell_usb_string(usb3::strings(options.genicam.serial), setup);
    if (setup[0] != set_endpoint || setup[1] != set_feature) return -EPIPE;
    const std::lock_guard lock(mutex);
    setup[4] == usb3::frames ? drop_frames() : answers.clear();
    return 0;
  }

  void take(std::uint8_t, std::span<const std::uint8_t> bytes) override {
    Bytes answer = memory.answer(bytes);
    const std::lock_guard lock(mutex);
    const bool is_lost = options.loses_trigger_answers && Usb3Memory::writes(registers::trigger_software, bytes) &&
                         !std::exchange(lost_last, !lost_last);
    if (!answer.empty() && !is_lost) answers.push_back(std::move(answer));
    if (!memory.stream_enabled()) drop_frames();
  }

  std::optional<std::size_t> give(std::uint8_t endpoint, std::span<std::uint8_t> room, Clock::time_point) override {
    const std::lock_guard lock(mutex);
    if (endpoint == usb3::answers) {
      if (answers.empty()) return std::nullopt;
      const Bytes answer = std::move(answers.front());
      answers.pop_front();
      const std::size_t count = std::min(room.size(), answer.size());
      std::copy_n(answer.begin(), count, room.begin());
      return count;
    }
    if (transfers.empty()) return std::nullopt;
    Transfer& now = transfers.front();
    const std::size_t count = std::min(room.size(), now.bytes.size() - now.given);
    std::copy_n(now.bytes.begin() + std::ptrdiff_t(now.given), count, room.begin());
    now.given += count;
    if (now.given < now.bytes.size()) return count;
    if (now.ends_frame) --frames_kept;
    transfers.pop_front();
    return count;
  }

  bool acquiring() const override { return memory.get(registers::acquisition) != 0 && memory.stream_enabled(); }
  std::uint64_t stream() const override { return memory.streams(); }

  void send(const Exposure& exposure, std::stop_token) override {
    const std::uint64_t stream = memory.streams();
    const auto now = std::chrono::steady_clock::now().time_since_epoch();
    FrameHead head{0,
                   std::uint64_t(std::chrono::nanoseconds(now).count()),
                   sensor.format().code,
                   memory.get(registers::width),
                   memory.get(registers::height),
                   memory.get(registers::offset_x),
                   memory.get(registers::offset_y)};
    Bytes bytes(sensor.format().bytes_of(std::size_t(head.width) * head.height));
    sensor.read_out(exposure, int(head.width), int(head.height), bytes);
    {
      const std::lock_guard lock(mutex);
      if (std::exchange(numbered_stream, stream) != stream) next_number = 0;
      head.number = next_number++;
      if (!acquiring() || memory.streams() != stream || frames_kept == most_frames) return;
      const bool is_cut = options.cut_every > 0 && (head.number + 1) % std::uint64_t(options.cut_every) == 0;
      if (is_cut) bytes.resize(bytes.size() / 2);
      push(head, bytes);
    }
    device.give();
  }

  void push(const FrameHead& head, const Bytes& bytes) {
    transfers.push_back({leader(head)});
    std::size_t sent = 0;
    for (const std::size_t size : memory.transfers(bytes.size())) {
      const auto begin = bytes.begin() + std::ptrdiff_t(sent);
      transfers.push_back({Bytes(begin, begin + std::ptrdiff_t(size))});
      sent += size;
    }
    transfers.push_back({trailer(head, sent), 0, true});
    ++frames_kept, ++frames_sent;
  }
};

Result<std::unique_ptr<Usb3Camera>> Usb3Camera::start(UsbBus& bus, const Options& options, Sight sight) {
  if (Status checked = check(options.genicam); !checked) return tl::unexpected(checked.error());
  std::unique_ptr<Usb3Camera> camera(new Usb3Camera(std::make_unique<Impl>(bus, options, std::move(sight))));
  if (Status plugged = camera->plug(); !plugged) return tl::unexpected(plugged.error());
  Impl* const impl = camera->impl_.get();
  impl->exposure_thread = std::jthread([impl](std::stop_token stop) { impl->sensor.run(*impl, stop); });
  return camera;
}

Usb3Camera::Usb3Camera(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Usb3Camera::~Usb3Camera() = default;

Status Usb3Camera::plug() { return impl_->device.plug(); }
void Usb3Camera::unplug() {
  impl_->device.unplug();
  impl_->power_up();  // without power, until it is plugged in: no stream, no exposure
}
void Usb3Camera::freeze(bool frozen) { impl_->sensor.freeze(frozen); }
std::uint64_t Usb3Camera::frames_sent() const { return impl_->frames_sent; }

}  // namespace lumifield::virtual_bench
