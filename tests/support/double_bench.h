#pragma once

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <memory>
#include <mutex>

#include "app/session/bench_devices.h"
#include "tests/support/bench_doubles.h"

namespace lumifield::test {

/// A bench whose devices are doubles in process, opened anew whenever they are asked for. It counts those that are
/// open, and holds the camera's opening and its exposures back when told. Outlives what it opened. Thread-safe.
class DoubleBench {
 public:
  DoubleBench(int width_px, int height_px) : width_px_(width_px), height_px_(height_px) {}

  BenchDevices devices() {
    return {[this](const CameraSettings&) { return open_camera(); },
            [this](const StageSettings&) { return open_stage(); }};
  }

  /// The camera refuses to open, until told otherwise.
  void refuse_camera(bool refuse) { refuse_ = refuse; }
  /// Holds the next openings, or exposures, back until let go.
  void hold_opening(bool hold) { set(openings_left_, hold ? 0 : endless); }
  void hold_exposures(bool hold) { set(exposures_left_, hold ? 0 : endless); }
  void hold_exposures_after(int exposures) { set(exposures_left_, exposures); }

  /// The move after so many from now on ends in an alarm.
  void trip_stage_after(int moves) { moves_to_trip_ = moves + 1; }

  int cameras_opened() const { return cameras_.opened; }
  int stages_opened() const { return stages_.opened; }
  int open_now() const { return cameras_.open + stages_.open; }
  int most_cameras_at_once() const { return cameras_.most; }
  int most_stages_at_once() const { return stages_.most; }

 private:
  struct Count {
    std::atomic<int> open = 0, opened = 0, most = 0;
    void up() {
      ++opened;
      most = std::max<int>(most, ++open);
    }
  };
  /// Lit but where the opaque patch stands before the lamp.
  class Camera final : public lumifield::Camera {
   public:
    explicit Camera(DoubleBench& bench) : bench_(bench) {
      bench_.cameras_.up();
      double_.camera_info.sensor_width_px = bench.width_px_;
      double_.camera_info.sensor_height_px = bench.height_px_;
      double_.signal_dn_per_s = [](const Vec2& at) { return at.y() > 45 ? 0.0 : 5e4; };
    }
    ~Camera() override { --bench_.cameras_.open; }
    const CameraInfo& info() const override { return double_.info(); }
    Result<RawImage> expose(double exposure_s) override {
      bench_.pass(bench_.exposures_left_);
      stage_.at = bench_.stage_at();
      return double_.expose(exposure_s);
    }
    int frames_retaken() const override { return double_.frames_retaken(); }

   private:
    DoubleBench& bench_;
    ManualClock clock_;
    StageDouble stage_{clock_};
    CameraDouble double_{clock_, stage_};
  };
  class Stage final : public lumifield::Stage {
   public:
    explicit Stage(DoubleBench& bench) : bench_(bench) { bench_.stages_.up(); }
    ~Stage() override { --bench_.stages_.open; }
    const StageInfo& info() const override { return double_.info(); }
    Status home(std::stop_token stop) override { return double_.home(stop); }
    Status move_to(const Vec2& target_mm, std::stop_token stop) override {
      if (--bench_.moves_to_trip_ == 0) double_.alarm = true;
      const Status moved = double_.move_to(target_mm, stop);
      bench_.stage_stands(double_.at);
      return moved;
    }
    Result<Vec2> position() override { return double_.position(); }
    void halt() override { double_.halt(); }

   private:
    DoubleBench& bench_;
    ManualClock clock_;
    StageDouble double_{clock_};
  };

  Result<std::unique_ptr<lumifield::Camera>> open_camera() {
    pass(openings_left_);
    if (refuse_) return fail("the camera does not answer", "camera", "check its cable");
    return std::make_unique<Camera>(*this);
  }
  Result<std::unique_ptr<lumifield::Stage>> open_stage() { return std::make_unique<Stage>(*this); }
  void set(int& left, int now) {
    const std::lock_guard lock(mutex_);
    left = now;
    changed_.notify_all();
  }
  void pass(int& left) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return left > 0; });
    --left;
  }
  void stage_stands(const Vec2& at) {
    const std::lock_guard lock(mutex_);
    stage_at_ = at;
  }
  Vec2 stage_at() {
    const std::lock_guard lock(mutex_);
    return stage_at_;
  }

  static constexpr int endless = 1 << 30;
  const int width_px_, height_px_;
  std::atomic<bool> refuse_ = false;
  std::atomic<int> moves_to_trip_ = 0;
  Count cameras_, stages_;
  std::mutex mutex_;
  std::condition_variable changed_;
  int openings_left_ = endless, exposures_left_ = endless;
  Vec2 stage_at_{0, 0};
};

}  // namespace lumifield::test
