#pragma once

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <mutex>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "luminaire/geometry.h"
#include "tests/support/pty.h"

namespace lumifield {

/// The far end of a serial line that answers as GRBL 1.1 does, at constant speed and without a planner, and goes wrong
/// when told: for the faults that a faithful controller seldom shows. Thread-safe.
class ScriptedGrbl {
 public:
  struct Script {
    double speed_mm_s = 100;
    std::string firmware = "1.1h.20190825";
    bool locked = true;  ///< an alarm after power-up, as with $22=1
    bool homing_ends = true;
    bool blocked = false;         ///< in a critical alarm: answers nothing but a reset
    bool reports_work = false;    ///< $10=0: WPos, and WCO with every 5th report
    bool reports_inches = false;  ///< $13=1
    Vec2 work_offset_mm{0, 0};
    std::string boot_noise;  ///< sent instead of any answer
  };
  /// What goes wrong as soon as the stage has moved `fault_after_mm`.
  enum class Fault { none, silence, garbage, alarm, door, hold, restart, unplug, freeze };

  ScriptedGrbl() : ScriptedGrbl(Script{}) {}
  explicit ScriptedGrbl(Script script)
      : script_(std::move(script)), path_(pty_.path()), state_(script_.locked ? "Alarm" : "Idle") {
    worker_ = std::jthread([this](std::stop_token stop) { serve(stop); });
  }

  const std::string& path() const { return path_; }
  void set_fault(Fault fault, double fault_after_mm = 0) {
    const std::scoped_lock lock(mutex_);
    fault_ = fault;
    fault_after_mm_ = fault_after_mm;
  }
  Vec2 position() const { return locked_copy(position_); }
  std::string state() const { return locked_copy(state_); }
  std::vector<std::string> lines() const { return locked_copy(lines_); }

 private:
  using Clock = std::chrono::steady_clock;

  template <class T>
  T locked_copy(const T& value) const {
    const std::scoped_lock lock(mutex_);
    return value;
  }

  void serve(std::stop_token stop) {
    while (!stop.stop_requested()) {
      const std::string bytes = pty_.receive(1);
      const std::scoped_lock lock(mutex_);
      if (is_unplugged_) return;
      advance();
      for (const char each : bytes) take(each);
    }
  }

  void say(const std::string& line) {
    if (is_silent_ || is_unplugged_) return;
    pty_.send(script_.boot_noise.empty() ? (is_garbled_ ? "\x81\x02~~" : line) + "\r\n" : script_.boot_noise);
  }

  void advance() {
    const Clock::time_point now = Clock::now();
    const double step = script_.speed_mm_s * std::chrono::duration<double>(now - last_).count();
    last_ = now;
    if (state_ != "Run" || is_frozen_) return;
    const Vec2 left = target_ - position_;
    moved_mm_ += std::min(step, left.norm());
    if (left.norm() <= step) {
      position_ = target_;
      state_ = "Idle";
    } else {
      position_ += left / left.norm() * step;
    }
    if (fault_ != Fault::none && moved_mm_ >= fault_after_mm_) fail_now();
  }

  void fail_now() {
    switch (fault_) {
      case Fault::silence:
        is_silent_ = true;
        break;
      case Fault::garbage:
        is_garbled_ = true;
        break;
      case Fault::alarm:
        say("ALARM:1");
        say("[MSG:Reset to continue]");
        state_ = "Alarm";
        script_.blocked = true;
        break;
      case Fault::door:
        state_ = "Door:0";
        break;
      case Fault::hold:
        state_ = "Hold:0";
        break;
      case Fault::restart:
        state_ = "Alarm";
        reset();
        break;
      case Fault::unplug:
        is_unplugged_ = true;
        pty_.unplug();
        break;
      case Fault::freeze:
        is_frozen_ = true;
        break;
      case Fault::none:
        break;
    }
    fault_ = Fault::none;
  }

  void take(char each) {
    if (each == 0x18) return reset();
    if (script_.blocked) return;
    if (each == '?') return report();
    if (each == '!') return hold();
    if (each == '\n') {
      lines_.push_back(line_);
      if (state_ != "Home") obey(std::exchange(line_, ""));
    } else if (each != '\r') {
      line_ += each;
    }
  }

  void reset() {
    script_.blocked = false;
    line_.clear();
    if (state_ == "Run" || state_ == "Home") {
      say(state_ == "Run" ? "ALARM:3" : "ALARM:6");
      state_ = "Alarm";
    }
    if (state_ == "Hold:0") state_ = "Idle";
    is_frozen_ = false;
    reports_ = 0;
    say("");
    say("Grbl 1.1h ['$' for help]");
    if (state_ == "Alarm") say("[MSG:'$H'|'$X' to unlock]");
  }

  void hold() {
    if (state_ == "Idle" || (state_ == "Run" && !is_frozen_)) state_ = "Hold:0";
  }

  void report() {
    const double unit = script_.reports_inches ? 25.4 : 1;
    const Vec2 offset = script_.work_offset_mm / unit;
    const Vec2 shown = position_ / unit - (script_.reports_work ? offset : Vec2(0, 0));
    char text[160], work[80] = "";
    if (reports_++ % 5 == 4) std::snprintf(work, sizeof work, "|WCO:%.4f,%.4f,0.000", offset.x(), offset.y());
    std::snprintf(text, sizeof text, "<%s|%s:%.4f,%.4f,0.000|FS:0,0%s>", state_.c_str(),
                  script_.reports_work ? "WPos" : "MPos", shown.x(), shown.y(), work);
    say(text);
  }

  void obey(const std::string& line) {
    if (line == "$I") {
      say("[VER:" + script_.firmware + ":]");
      say("[OPT:V,15,128]");
    } else if (line == "$$") {
      say(script_.reports_work ? "$10=0" : "$10=1");
      say(script_.reports_inches ? "$13=1" : "$13=0");
      for (const char* each :
           {"$22=1", "$24=25.000", "$25=500.000", "$27=1.000", "$100=250.000", "$101=250.000", "$110=6000.000",
            "$111=5000.000", "$120=500.000", "$121=400.000", "$130=200.000", "$131=150.000", "$132=50.000"})
        say(each);
    } else if (line == "$H") {
      if (!script_.homing_ends) {
        state_ = "Home";
        return;
      }
      position_ = Vec2(0, 0);
      state_ = "Idle";
    } else if (state_ == "Alarm") {
      return say("error:9");
    } else if (double x, y; std::sscanf(line.c_str(), "G21 G90 G53 G0 X%lf Y%lf", &x, &y) == 2) {
      if (x < 0 || y < 0 || x > 200 || y > 150) {
        say("ALARM:2");
        state_ = "Alarm";
        script_.blocked = true;
        return;
      }
      target_ = Vec2(x, y);
      state_ = "Run";
    } else {
      return say("error:20");
    }
    say("ok");
  }

  mutable std::mutex mutex_;
  Script script_;
  Pty pty_;
  std::string path_;
  std::string state_, line_;
  std::vector<std::string> lines_;
  Vec2 position_{0, 0}, target_{0, 0};
  double moved_mm_ = 0, fault_after_mm_ = 0;
  Fault fault_ = Fault::none;
  bool is_silent_ = false, is_garbled_ = false, is_unplugged_ = false, is_frozen_ = false;
  int reports_ = 0;
  Clock::time_point last_ = Clock::now();
  std::jthread worker_;
};

}  // namespace lumifield
