#include "acquisition/virtual/apt_controller.h"

#include <chrono>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <optional>
#include <thread>

#include "acquisition/virtual/apt_channel.h"
#include "acquisition/virtual/ftdi_chip.h"

namespace lumifield::virtual_bench {

namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;
using Bytes = FtdiChip::Bytes;

constexpr std::size_t header_bytes = 6;
constexpr std::uint8_t data_follow = 0x80, unit_address = 0x50, rack_address = 0x11, first_bay = 0x21;
constexpr milliseconds both_axes_time(5);  // in which the other axis's move comes, too

constexpr AptChannel::Scale servo(double counts_per_mm, double loop_s) {
  return {counts_per_mm, 65536 * loop_s, 65536 * loop_s * loop_s};
}

struct Model {
  const char *controller, *name, *product;
  std::vector<std::string> serials;  ///< of the units: one for each axis, or a rack
  bool is_servo;
  AptChannel::Scale scale;

  bool is_rack() const { return serials.size() == 1; }
  std::uint8_t address() const { return is_rack() ? rack_address : unit_address; }
};

/// With the motors of MTS50-Z8, of a stepper with the steps of the GRBL stage, and of DDS220.
Model model_of(AptOptions::Kind kind) {
  switch (kind) {
    case AptOptions::Kind::stepper_rack:
      return {"bsc20x", "BSC202", "APT Stepper Motor Controller", {"70000001"}, false, {250, 53.68, 53.68 * 204.94e-6}};
    case AptOptions::Kind::servo_rack:
      return {"bbd30x", "BBD302", "Brushless Motor Controller", {"103000001"}, true, servo(20000, 102.4e-6)};
    case AptOptions::Kind::pair:
      break;
  }
  const std::vector<std::string> serials{"27000001", "27000002"};
  return {"kdc101", "KDC101", "Kinesis K-Cube DC Driver", serials, true, servo(34304, 2048 / 6e6)};
}

}  // namespace

struct AptController::Impl {
  AptOptions options;
  std::function<void(const Vec2&)> prepare;
  Model model;

  std::mutex wake_mutex;  // guards woken; taken alone, or by a chip
  std::condition_variable wake;
  bool woken = false;
  std::vector<std::unique_ptr<FtdiChip>> chips;

  std::mutex mutex;          // guards all below
  std::vector<Bytes> lines;  // by unit, what is not yet a message
  std::vector<AptChannel> axes;
  Clock::time_point advanced = Clock::now();
  std::optional<Clock::time_point> prepare_at;
  bool silent = false;
  milliseconds delay{0};
  struct Late {
    Clock::time_point due;
    std::size_t unit;
    Bytes bytes;
  };
  std::deque<Late> late;  // as they were sent

  std::jthread thread;  // the last, so that it ends before what it uses

  Status open(UsbBus& bus) {
    for (const std::string& serial : model.serials) {
      auto chip = FtdiChip::plug(bus, model.product, serial, [this] {
        const std::lock_guard lock(wake_mutex);
        woken = true;
        wake.notify_one();
      });
      if (!chip) return tl::unexpected(chip.error());
      chips.push_back(std::move(*chip));
    }
    lines.resize(chips.size());
    for (int axis : {0, 1}) {
      const auto address = static_cast<std::uint8_t>(model.is_rack() ? first_bay + axis : unit_address);
      axes.emplace_back(address, model.is_servo, model.scale, options.power_up_mm[axis], options.homing_mm_s,
                        options.most_mm_s);
      axes.back().tells_completion = options.tells_completion;
      axes.back().set_speed(options.rapid_mm_s, options.acceleration_mm_s2);
    }
    return {};
  }

  /// Acts on the machine as it stands now.
  template <class F>
  auto now(F&& act) {
    const std::lock_guard lock(mutex);
    advance();
    return act();
  }

  void advance() {
    const auto time = Clock::now();
    const double seconds = std::chrono::duration<double>(time - advanced).count();
    advanced = time;
    for (std::size_t axis = 0; axis < axes.size(); ++axis) send(unit_of(axis), axes[axis].advance(seconds));
  }

  std::size_t unit_of(std::size_t axis) const { return model.is_rack() ? 0 : axis; }

  void send(std::size_t unit, const Bytes& bytes) {
    if (silent || bytes.empty()) return;
    late.push_back({Clock::now() + delay, unit, bytes});
    send_due();
  }

  void send_due() {
    for (; !late.empty() && late.front().due <= Clock::now(); late.pop_front())
      chips[late.front().unit]->send(late.front().bytes);
  }

  void run(std::stop_token stop) {
    while (!stop.stop_requested()) {
      bool busy = false;
      now([&] {
        for (std::size_t unit = 0; unit < chips.size(); ++unit) {
          const Bytes came = chips[unit]->take();
          lines[unit].insert(lines[unit].end(), came.begin(), came.end());
          while (const std::optional<Bytes> message = next(lines[unit])) take(unit, *message);
          busy = chips[unit]->tick() || busy;
        }
        send_due();
        busy = busy || axes[0].moving() || axes[1].moving() || !late.empty();
        if (prepare_at && Clock::now() >= *prepare_at) {
          prepare_at.reset();
          if (prepare) prepare({axes[0].motor.true_target_mm().x(), axes[1].motor.true_target_mm().x()});
        }
      });
      std::unique_lock lock(wake_mutex);
      wake.wait_for(lock, milliseconds(busy ? 1 : 10), [this] { return std::exchange(woken, false); });
    }
  }

  static std::optional<Bytes> next(Bytes& line) {
    if (line.size() < header_bytes) return std::nullopt;
    const std::size_t data = (line[4] & data_follow) != 0 ? std::size_t(line[2] | line[3] << 8) : 0;
    if (line.size() < header_bytes + data) return std::nullopt;
    const auto end = line.begin() + std::ptrdiff_t(header_bytes + data);
    Bytes message(line.begin(), end);
    line.erase(line.begin(), end);
    return message;
  }

  void take(std::size_t unit, const Bytes& message) {
    const std::uint8_t address = message[4] & ~data_follow;
    const int id = message[0] | message[1] << 8;
    if (id == 0x0005 && address == model.address()) return send(unit, hardware(unit));
    for (std::size_t axis = 0; axis < axes.size(); ++axis) {
      if (unit_of(axis) != unit || axes[axis].address() != address) continue;
      send(unit, axes[axis].take(message));
      if (id == 0x0453) prepare_at = Clock::now() + both_axes_time;
    }
  }

  /// HW_GET_INFO.
  Bytes hardware(std::size_t unit) const {
    Bytes told{0x06, 0x00, 84, 0, 0x01 | data_follow, model.address()};
    put_u32(told, std::uint32_t(std::stoul(model.serials[unit])));
    std::string name = model.name;
    name.resize(8);
    told.insert(told.end(), name.begin(), name.end());
    put_u16(told, 44);
    for (const int part : {5, 1, 2, 0}) told.push_back(std::uint8_t(part));
    told.resize(header_bytes + 78);
    for (const int number : {1, 0, model.is_rack() ? 2 : 1}) put_u16(told, std::uint16_t(number));
    return told;
  }

  template <class F>
  Vec2 each(F&& of) {
    return now([&] { return Vec2(of(axes[0]), of(axes[1])); });
  }
};

Result<std::unique_ptr<AptController>> AptController::start(UsbBus& bus, const AptOptions& options,
                                                            std::function<void(const Vec2&)> prepare) {
  auto impl = std::make_unique<Impl>();
  impl->options = options;
  impl->model = model_of(options.kind);
  impl->prepare = std::move(prepare);
  if (Status opened = impl->open(bus); !opened) return tl::unexpected(opened.error());
  impl->thread = std::jthread([self = impl.get()](std::stop_token stop) { self->run(stop); });
  return std::unique_ptr<AptController>(new AptController(std::move(impl)));
}

AptController::AptController(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
AptController::~AptController() = default;

const char* AptController::controller() const { return impl_->model.controller; }
std::vector<std::string> AptController::serials() const { return impl_->model.serials; }
double AptController::counts_per_mm() const { return impl_->model.scale.counts_per_mm; }

Vec2 AptController::true_position_mm() const {
  return impl_->each([](const AptChannel& axis) { return axis.motor.true_mm().x(); });
}
Vec2 AptController::off_mm() const {
  return impl_->each([](const AptChannel& axis) { return axis.motor.true_mm().x() - axis.reading_mm(); });
}
void AptController::lose_steps(double mm_per_move) {
  impl_->now([&] {
    for (AptChannel& axis : impl_->axes) axis.motor.lost_mm_per_move = mm_per_move;
  });
}
void AptController::set_backlash(double mm) {
  impl_->now([&] {
    for (AptChannel& axis : impl_->axes) axis.motor.backlash_mm = mm;
  });
}
void AptController::stick(bool stuck) {
  impl_->now([&] {
    for (AptChannel& axis : impl_->axes) axis.motor.stuck = stuck;
  });
}
void AptController::silence(bool silent) {
  impl_->now([&] { impl_->silent = silent; });
}
void AptController::trip_limit() {
  impl_->now([&] { impl_->axes[0].trip_limit(); });
}
void AptController::trip_motion_error() {
  impl_->now([&] { impl_->axes[0].trip_motion_error(); });
}
void AptController::delay(milliseconds by) {
  impl_->now([&] { impl_->delay = by; });
}
void AptController::say(const std::vector<std::uint8_t>& bytes) {
  impl_->now([&] { impl_->send(0, bytes); });
}
Status AptController::unplug(bool out) {
  for (const auto& chip : impl_->chips) {
    if (out) chip->unplug();
    if (const Status plugged = out ? Status() : chip->plug(); !plugged) return plugged;
  }
  return {};
}

}  // namespace lumifield::virtual_bench
