#pragma once

#include <algorithm>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "acquisition/camera.h"
#include "acquisition/scan/bench_clock.h"
#include "acquisition/scan/motion_time.h"
#include "acquisition/stage.h"
#include "luminaire/wording.h"

namespace lumifield::test {

/// A clock that only moves when told: waits and devices advance it. `on_wait` runs in every wait.
class ManualClock final : public BenchClock {
 public:
  double now_s() override { return now; }
  bool wait(double seconds, std::stop_token stop) override {
    if (on_wait) on_wait();
    if (stop.stop_requested()) return false;
    now += seconds;
    return true;
  }

  double now = 0;
  std::function<void()> on_wait;
};

/// A stage in process, on a manual clock. The knobs act from the next call on; moves are counted from 1.
class StageDouble final : public Stage {
 public:
  explicit StageDouble(ManualClock& manual_clock) : clock(manual_clock) {}

  const StageInfo& info() const override { return stage_info; }
  Status home(std::stop_token stop = {}) override {
    ++homings;
    if (stop.stop_requested()) return halted();
    if (home_error) return tl::unexpected(*home_error);
    at = slip_mm = {0, 0};
    clock.now += home_s;
    return {};
  }
  Result<Vec2> slipped_mm(std::stop_token stop = {}) override {
    ++looks;
    if (stop.stop_requested()) return halted();
    if (alarm) return fail("alarm 1: a limit switch was hit", "stage", "home it");
    at = {0, 0};
    clock.now += look_s;
    return slip_mm;
  }
  Status move_to(const Vec2& target_mm, std::stop_token stop = {}) override {
    ++moves;
    targets.push_back(target_mm);
    if (on_move) on_move(moves);
    if (stop.stop_requested()) return halted();
    if (moves == alarm_at_move) alarm = true;
    if (alarm) return fail("alarm 1: a limit switch was hit", "stage", "home it");
    clock.now += move_time_s({stage_info.rapid_mm_s, stage_info.acceleration_mm_s2}, at, target_mm);
    at = target_mm;
    if (moves >= off_from_move && moves < off_until_move) at += off_by_mm;
    return {};
  }
  Result<Vec2> position() override {
    ++positions_read;
    if (silent) return fail("no answer within 5 s", "stage", "check the cable");
    return at;
  }
  void halt() override { ++halts; }
  static tl::unexpected<Error> halted() {
    return tl::unexpected<Error>({"stopped by the operator", "stage", {}, ErrorKind::stopped});
  }

  ManualClock& clock;
  StageInfo stage_info{"double", "memory", 50, 500, {200, 200}};
  double home_s = 3, look_s = 2;
  Vec2 slip_mm{0, 0};  ///< until it is homed; positions do not tell
  std::optional<Error> home_error;
  int alarm_at_move = 0;  ///< 0 = never
  bool alarm = false, silent = false;
  int off_from_move = 0, off_until_move = 0;  ///< half-open: these moves end off_by_mm beside the target
  Vec2 off_by_mm{0, 0};
  std::function<void(int move)> on_move;

  Vec2 at{0, 0};
  int homings = 0, looks = 0, moves = 0, positions_read = 0, halts = 0;
  std::vector<Vec2> targets;
};

/// A camera in process, on a manual clock: uniform frames of black level + signal·exposure, clipped at 12 bits. Frames
/// are counted from 1.
class CameraDouble final : public Camera {
 public:
  CameraDouble(ManualClock& manual_clock, StageDouble& in_front) : clock(manual_clock), stage(in_front) {}

  const CameraInfo& info() const override { return camera_info; }
  Result<RawImage> expose(double exposure_s) override {
    ++frames;
    if (on_expose) on_expose(frames);
    if (frames == fail_at_frame) return fail("the camera is gone", "camera", "check its cable");
    if (refuse_from_frame > 0 && frames >= refuse_from_frame)
      return refused_for_good(
          {"an exposure of " + say(exposure_s) + " s is out of its range", "camera", "choose another"});
    clock.now += exposure_s + readout_s;
    RawImage image;
    image.width_px = camera_info.sensor_width_px, image.height_px = camera_info.sensor_height_px;
    image.exposure_s = exposure_s;
    image.frame_id = static_cast<std::uint64_t>(frames);
    const double dn = black_dn + (signal_dn_per_s ? signal_dn_per_s(stage.at) : 0) * exposure_s;
    image.dn.assign(static_cast<std::size_t>(image.width_px) * static_cast<std::size_t>(image.height_px),
                    static_cast<std::uint16_t>(std::clamp(dn, 0.0, 4095.0)));
    return image;
  }
  int frames_retaken() const override { return 0; }

  ManualClock& clock;
  StageDouble& stage;
  CameraInfo camera_info{"double", "memory", "1", "memory", 8, 4};
  double readout_s = 0.01, black_dn = 64;
  std::function<double(const Vec2& stage_mm)> signal_dn_per_s;
  int fail_at_frame = 0, refuse_from_frame = 0;  ///< 0 = never
  std::function<void(int frame)> on_expose;

  int frames = 0;
};

}  // namespace lumifield::test
