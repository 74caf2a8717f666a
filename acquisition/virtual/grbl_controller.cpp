#include "acquisition/virtual/grbl_controller.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <mutex>
#include <thread>

#include "acquisition/virtual/grbl_lines.h"
#include "acquisition/virtual/motion.h"
#include "acquisition/virtual/pseudo_terminal.h"

namespace lumifield::virtual_bench {

namespace {

using Clock = std::chrono::steady_clock;

constexpr char reset_byte = 0x18;
constexpr std::size_t receive_bytes = 127, most_line_bytes = 80;
constexpr int reports_between_offsets = 10;
constexpr double beyond_switch_mm = 5;  // from a switch to the stop behind it

enum class Mode { idle, home, alarm, dead };  // dead: until reset, after ALARM:1 and ALARM:2

}  // namespace

struct GrblController::Impl {
  GrblOptions options;
  std::function<void(const Vec2&)> prepare;
  PseudoTerminal terminal;

  std::mutex mutex;  // guards all below
  Axes axes;
  Clock::time_point advanced = Clock::now();
  GrblSettings settings;
  Gcode gcode;
  Mode mode = Mode::alarm;
  std::string received;           // not yet taken by the line reader
  std::string line;               // the one being read
  bool overflowed = false;        // that line was longer than GRBL takes
  bool answer_when_idle = false;  // the line under way is answered when the motion has ended
  bool answer_on_reset = false;
  bool silent = false;
  int reports = 0;

  std::jthread thread;  // the last, so that it ends before what it uses

  explicit Impl(const GrblOptions& o)
      : options(o), axes(o.power_up_mm), settings(o.travel_mm, o.rapid_mm_s, o.acceleration_mm_s2) {
    settings.set(o.soft_limits ? "20=1" : "20=0");
    settings.set(o.hard_limits ? "21=1" : "21=0");
  }

  /// Acts on the machine as it stands now.
  template <class F>
  auto now(F&& act) {
    const std::lock_guard lock(mutex);
    advance();
    return act();
  }

  // ---- The line to the host

  void send(const std::string& text) {
    if (!silent) terminal.write(text);
  }
  void send_line(const std::string& text) { send(text + "\r\n"); }
  void answer(GrblError error) { send_line(error == GrblError::none ? "ok" : "error:" + std::to_string(int(error))); }
  void welcome() {
    send("\r\nGrbl 1.1h ['$' for help]\r\n");
    if (mode == Mode::alarm) send_line("[MSG:'$H'|'$X' to unlock]");
  }

  void run(std::stop_token stop) {
    now([&] { welcome(); });
    bool moving = false;
    while (!stop.stop_requested()) {
      const std::string bytes = terminal.read(moving ? 1 : 10);
      now([&] {
        for (const char byte : bytes) take(byte);
        read_lines();
        moving = !axes.empty();
      });
    }
  }

  // ---- Real-time commands act on receipt; all else waits for the line reader

  void take(char byte) {
    if (byte == reset_byte) return reset();
    if (byte == '?') return report();
    if (byte == '!') return mode == Mode::idle ? axes.hold() : void();
    if (byte == '~') return mode == Mode::idle ? axes.resume() : void();
    if (static_cast<unsigned char>(byte) >= 0x80) return;  // overrides, jog cancel
    if (received.size() < receive_bytes) received += byte;
  }

  void reset() {
    const bool position_lost = !axes.empty() && !axes.held();
    if (mode == Mode::home)
      alarm(6, Mode::alarm);
    else if (mode == Mode::idle && position_lost)
      alarm(3, Mode::alarm);
    else if (mode == Mode::dead)
      mode = Mode::alarm;
    axes.kill();
    gcode = {};
    if (answer_on_reset) answer(GrblError::none);
    answer_on_reset = answer_when_idle = overflowed = false;
    received.clear();
    line.clear();
    welcome();
  }

  void alarm(int number, Mode next) {
    axes.kill();
    mode = next;
    answer_when_idle = false;
    send_line("ALARM:" + std::to_string(number));
    if (next == Mode::dead) send_line("[MSG:Reset to continue]");
  }

  std::string state_name() const {
    if (mode != Mode::idle) return mode == Mode::home ? "Home" : "Alarm";
    if (axes.held()) return "Hold:0";
    if (axes.stopping()) return "Hold:1";
    return axes.empty() ? "Idle" : "Run";
  }

  void report() {
    const auto point = [](const Vec2& mm) {
      char text[80];
      std::snprintf(text, sizeof text, "%.3f,%.3f,0.000", mm.x(), mm.y());
      return std::string(text);
    };
    const int shown = int(settings[10]);
    std::string text = "<" + state_name() + ((shown & 1) != 0 ? "|MPos:" : "|WPos:") + point(axes.claimed_mm());
    if ((shown & 2) != 0)
      text += "|Bf:" + std::to_string(axes.free_slots()) + "," + std::to_string(receive_bytes - received.size());
    text += "|FS:" + std::to_string(std::lround(axes.speed_mm_s() * 60)) + ",0";
    const Eigen::Array2d at = axes.true_mm().array();
    const Eigen::Array<bool, 2, 1> closed = at <= low() || at >= high().array();
    if (closed.any()) text += std::string("|Pn:") + (closed.x() ? "X" : "") + (closed.y() ? "Y" : "");
    if (reports % reports_between_offsets == 0) text += "|WCO:" + point({0, 0});
    if (reports++ % reports_between_offsets == 1) text += "|Ov:100,100,100";
    send_line(text + ">");
  }

  // ---- The machine

  // Where the switches close, on the true scale.
  double low() const { return -settings[27]; }
  Vec2 high() const { return options.travel_mm + Vec2::Constant(settings[27]); }

  void advance() {
    const auto now = Clock::now();
    axes.advance(std::chrono::duration<double>(now - advanced).count());
    advanced = now;
  }

  void after_motion() {
    const Vec2 at = axes.true_mm(), past = Vec2::Constant(settings.on(21) ? 0 : beyond_switch_mm);
    const Vec2 inside = at.cwiseMax(Vec2::Constant(low()) - past).cwiseMin(high() + past);
    if (mode != Mode::home && inside != at) {
      axes.stands_at(inside, axes.claimed_mm());
      if (settings.on(21)) alarm(1, Mode::dead);
    }
    if (!answer_when_idle || !axes.empty()) return;
    if (mode == Mode::home) {
      axes.stands_at(Vec2::Zero(), Vec2::Zero());
      mode = Mode::idle;
    }
    answer_when_idle = false;
    answer(GrblError::none);
  }

  void home() {
    // Seek both switches, pull off, find them again slowly, pull off.
    mode = Mode::home;
    const Vec2 at_switch = axes.claimed_mm() + Vec2::Constant(low()) - axes.true_mm();
    const Vec2 pulled_off = at_switch + Vec2::Constant(settings[27]);
    push_line(at_switch, settings[25]);
    push_line(pulled_off, settings[25]);
    push_line(at_switch, settings[24]);
    push_line(pulled_off, settings[25]);
    answer_when_idle = true;
  }

  /// A line from where the queue ends, at the feed or the fastest that the axes' settings allow along it.
  void push_line(const Vec2& to, double feed_mm_min, double dwell_s = 0) {
    const Vec2 from = axes.target_mm();
    const Eigen::Array2d share = (to - from).normalized().array().abs();
    const auto along = [&](int setting) { return (settings.axes(setting).array() / share).minCoeff(); };
    axes.push({from, to, std::min(along(110), feed_mm_min) / 60, along(120), dwell_s});
  }

  // ---- Lines

  // A line is taken when the machine can act on it: not while homing, dwelling, held or dead, nor with a full planner.
  bool ready() const {
    return !answer_when_idle && !axes.held() && !axes.stopping() && mode != Mode::dead && axes.free_slots() > 0;
  }

  void read_lines() {
    after_motion();
    std::size_t used = 0;
    while (used < received.size() && ready()) {
      const char byte = received[used++];
      if (byte == '\n' || byte == '\r') {
        const std::string taken = std::exchange(line, {});
        if (std::exchange(overflowed, false))
          answer(GrblError::line_too_long);
        else
          execute(taken);
      } else if (line.size() < most_line_bytes) {
        line += byte;
      } else {
        overflowed = true;
      }
    }
    received.erase(0, std::min(used, received.size()));
  }

  void execute(const std::string& text) {
    const std::string bare = stripped(text);
    if (bare.empty()) return answer(GrblError::none);
    if (bare[0] == '$') return execute_system(bare);
    execute_motion(bare);
  }

  void execute_system(const std::string& command) {
    if (!axes.empty()) return answer(GrblError::not_idle);
    if (command == "$$")
      send(settings.list());
    else if (command == "$I")
      send("[VER:1.1h.20190825:LUMIFIELD]\r\n[OPT:VZ,15,128]\r\n");
    else if (command == "$X")
      unlock();
    else if (command == "$H" && !settings.on(22))
      return answer(GrblError::no_homing);
    else if (command == "$H")
      return home();
    else if (const GrblError error = settings.set(std::string_view(command).substr(1)); error != GrblError::none)
      return answer(error);
    answer(GrblError::none);
  }
  void unlock() {
    if (mode != Mode::alarm) return;
    mode = Mode::idle;
    send_line("[MSG:Caution: Unlocked]");
  }

  void execute_motion(const std::string& text) {
    if (mode == Mode::alarm) return answer(GrblError::locked);
    GcodeAction action;
    if (const GrblError error = gcode.execute(text, axes.target_mm(), action); error != GrblError::none)
      return answer(error);
    if (action.moves && settings.on(20) && beyond_travel(action.target_mm)) {
      answer_on_reset = true;
      return alarm(2, Mode::dead);
    }
    const Eigen::Array2d steps = settings.axes(100).array();
    if (action.moves) action.target_mm = (action.target_mm.array() * steps).round() / steps;
    if (action.moves || action.dwell_s > 0) push_line(action.target_mm, action.feed_mm_min, action.dwell_s);
    if (action.moves && prepare) prepare(axes.true_target_mm());
    if (action.dwell_s > 0)
      answer_when_idle = true;
    else
      answer(GrblError::none);
  }

  bool beyond_travel(const Vec2& target) const {
    return (target.array() < -1e-9).any() || (target.array() > settings.axes(130).array() + 1e-9).any();
  }
};

Result<std::unique_ptr<GrblController>> GrblController::start(const GrblOptions& options,
                                                              std::function<void(const Vec2&)> prepare) {
  auto impl = std::make_unique<Impl>(options);
  impl->prepare = std::move(prepare);
  if (auto opened = impl->terminal.open(options.path); !opened) return tl::unexpected(opened.error());
  impl->thread = std::jthread([self = impl.get()](std::stop_token stop) { self->run(stop); });
  return std::unique_ptr<GrblController>(new GrblController(std::move(impl)));
}

GrblController::GrblController(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
GrblController::~GrblController() = default;

Vec2 GrblController::true_position_mm() const {
  return impl_->now([&] { return impl_->axes.true_mm(); });
}
Vec2 GrblController::off_mm() const {
  return impl_->now([&] { return Vec2(impl_->axes.true_mm() - impl_->axes.claimed_mm()); });
}
void GrblController::lose_steps(double mm_per_move) {
  impl_->now([&] { impl_->axes.lost_mm_per_move = mm_per_move; });
}
void GrblController::set_backlash(double mm) {
  impl_->now([&] { impl_->axes.backlash_mm = mm; });
}
void GrblController::stick(bool stuck) {
  impl_->now([&] { impl_->axes.stuck = stuck; });
}
void GrblController::silence(bool silent) {
  impl_->now([&] { impl_->silent = silent; });
}
void GrblController::trip_limit() {
  impl_->now([&] { impl_->alarm(1, Mode::dead); });
}
Status GrblController::unplug(bool) {
  return fail("a stage on a terminal cannot be unplugged", impl_->options.path.string(), "use --stage apt");
}

}  // namespace lumifield::virtual_bench
