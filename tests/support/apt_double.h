#pragma once

#include <gtest/gtest.h>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "acquisition/stage.h"
#include "acquisition/virtual/apt_controller.h"
#include "luminaire/bench.h"
#include "tests/support/usb_bus.h"

namespace lumifield {

/// Virtual APT controllers on this program's own USB bus.
class AptDouble {
 public:
  using Kind = virtual_bench::AptOptions::Kind;

  static auto kinds() { return testing::Values(Kind::pair, Kind::stepper_rack, Kind::servo_rack); }
  static std::string name_of(const testing::TestParamInfo<Kind>& each) {
    if (each.param == Kind::pair) return "pair";
    return each.param == Kind::stepper_rack ? "stepper_rack" : "servo_rack";
  }

  explicit AptDouble(virtual_bench::AptOptions options = {}) : options_(options) {
    auto started = virtual_bench::AptController::start(test::usb_bus(), options, [this](const Vec2& at) {
      const std::scoped_lock lock(mutex_);
      prepared_.push_back(at);
    });
    EXPECT_TRUE(started) << started.error().message();
    server_ = std::move(*started);
  }

  virtual_bench::AptController& server() { return *server_; }
  std::vector<Vec2> prepared() const {
    const std::scoped_lock lock(mutex_);
    return prepared_;
  }

  StageSettings settings() const {
    StageSettings settings;
    settings.kind = "apt";
    settings.apt.serials = server_->serials();
    settings.apt.controller = server_->controller();
    settings.apt.counts_per_mm = Vec2::Constant(server_->counts_per_mm());
    settings.apt.travel_mm = options_.travel_mm;
    return settings;
  }
  std::unique_ptr<Stage> open() const { return open(settings()); }
  std::unique_ptr<Stage> open(const StageSettings& settings) const {
    auto stage = open_stage(settings);
    EXPECT_TRUE(stage) << stage.error().message();
    return stage ? std::move(*stage) : nullptr;
  }
  std::unique_ptr<Stage> open_homed() const {
    auto stage = open();
    if (!stage) return nullptr;
    const Status homed = stage->home();
    EXPECT_TRUE(homed) << homed.error().message();
    return stage;
  }

 private:
  virtual_bench::AptOptions options_;
  mutable std::mutex mutex_;
  std::vector<Vec2> prepared_;
  std::unique_ptr<virtual_bench::AptController> server_;
};

/// Each kind of them, to be opened by the production stage.
class AptStageTest : public testing::TestWithParam<AptDouble::Kind> {
 protected:
  using Kind = AptDouble::Kind;

  template <class T>
  static std::string message(const Result<T>& result) {
    return result ? "no error" : result.error().message();
  }
  void SetUp() override {
    if (!test::can_have_usb_bus()) GTEST_SKIP() << test::why_no_usb_bus;
    options_.kind = GetParam();
    options_.power_up_mm = {3, 2};
  }
  /// One whose moves take long enough to be met on the way.
  AptDouble slow() {
    options_.rapid_mm_s = 20;
    options_.acceleration_mm_s2 = 400;
    return AptDouble(options_);
  }
  /// Acts on another thread once the carriage has passed 2 mm in x.
  template <class F>
  static std::jthread on_the_way(AptDouble& controllers, F act) {
    return std::jthread([&controllers, act](std::stop_token stop) {
      while (!(controllers.server().true_position_mm().x() > 2) && !stop.stop_requested())
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
      act();
    });
  }
  /// How far a reading may be off, mm.
  static double a_count(AptDouble& controllers) { return 0.8 / controllers.server().counts_per_mm(); }

  virtual_bench::AptOptions options_;
};

}  // namespace lumifield
