// Scans on the production stage before virtual controllers on USB, attended by somebody who puts the plug in again.
#include <algorithm>
#include <atomic>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <thread>

#include "acquisition/scan/scanner.h"
#include "tests/support/apt_double.h"
#include "tests/support/small_bench.h"

namespace lumifield {
namespace {

using testing::HasSubstr;

class WatchingCamera final : public Camera {
 public:
  explicit WatchingCamera(AptDouble& controllers) : controllers_(controllers) {}
  const CameraInfo& info() const override { return info_; }
  int frames_retaken() const override { return 0; }
  Result<RawImage> expose(double exposure_s) override {
    at_mm.push_back(controllers_.server().true_position_mm());
    RawImage image;
    image.width_px = image.height_px = 1;
    image.exposure_s = exposure_s;
    image.frame_id = at_mm.size() - 1;
    image.dn = {static_cast<std::uint16_t>(at_mm.back().y() > 85 ? 64 : 1064)};
    return image;
  }
  std::vector<Vec2> at_mm;  ///< where the carriage truly stood, by frame

 private:
  AptDouble& controllers_;
  CameraInfo info_;
};

class Recovery final : public DeviceRecovery {
 public:
  Recovery(Camera& camera, std::unique_ptr<Stage> stage, StageSettings settings)
      : camera_(camera), stage_(std::move(stage)), settings_(std::move(settings)) {}
  Camera& camera() override { return camera_; }
  Stage& stage() override { return *stage_; }
  Status reopen_camera() override { return {}; }
  Status reopen_stage() override {
    auto opened = open_stage(settings_);
    if (!opened) return tl::unexpected(opened.error());
    stage_ = std::move(*opened);
    return {};
  }

 private:
  Camera& camera_;
  std::unique_ptr<Stage> stage_;
  StageSettings settings_;
};

/// Says "go on" to every trouble once the plug is in again.
class Operator final : public ScanSink {
 public:
  Operator(ScanControl& control, AptDouble& controllers) : control_(control), controllers_(controllers) {}
  void cell(RawCell raw) override {
    cells.push_back(std::move(raw));
    ++cells_taken;
  }
  void reference(const ReferenceReading&) override {}
  void notice(const std::string&) override {}
  void progress(const ScanProgress& progress) override {
    if (progress.state != ScanState::paused) return;
    troubles.push_back(progress.trouble);
    EXPECT_TRUE(controllers_.server().unplug(false));
    control_.resume();
  }
  std::vector<RawCell> cells;
  std::atomic<int> cells_taken = 0;
  std::vector<std::string> troubles;

 private:
  ScanControl& control_;
  AptDouble& controllers_;
};

TEST(ScanOnAptStage, UnpluggedOnTheWayItPausesAndGoesOnAtTheOperatorsWord) {
  if (!test::can_have_usb_bus()) GTEST_SKIP() << test::why_no_usb_bus;
  virtual_bench::AptOptions options;
  options.rapid_mm_s = 100;
  AptDouble controllers(options);
  Bench bench = test::small_bench();
  bench.stage = controllers.settings();
  bench.limits = {{0, 0}, options.travel_mm};
  bench.stage_to_luminaire.origin_mm = {-40, -40};  // the lamp's middle is at (40, 40)
  Plan plan = test::small_plan();
  plan.settle_s = 0;
  plan.exposures_s = {0.001};
  const Result<ScanPlan> steps = make_scan_plan(bench, plan);
  ASSERT_TRUE(steps) << steps.error().message();

  WatchingCamera camera(controllers);
  Recovery recovery(camera, controllers.open(), bench.stage);
  ScanControl control;
  control.attend();
  Operator sink(control, controllers);
  Scanner scanner(camera, recovery.stage(), bench, plan);
  scanner.obey(control);
  scanner.recover_with(recovery);
  std::jthread hand([&](std::stop_token stop) {
    Vec2 before = controllers.server().true_position_mm();
    while (!stop.stop_requested()) {
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
      const Vec2 at = controllers.server().true_position_mm();
      if (sink.cells_taken >= 2 && at != before) return (void)controllers.server().unplug(true);
      before = at;
    }
  });
  const Status scanned = scanner.run(*steps, sink, {});
  ASSERT_TRUE(scanned) << scanned.error().message();

  ASSERT_EQ(sink.troubles.size(), 1U);
  EXPECT_THAT(sink.troubles[0], HasSubstr("the stage is gone: unplugged or switched off; plug it in, then home"));
  ASSERT_EQ(sink.cells.size(), 6U);
  for (const RawCell& cell : sink.cells)
    for (const RawPass& pass : cell.passes)
      for (const RawImage& frame : pass.bracket) EXPECT_LT((camera.at_mm[frame.frame_id] - pass.stage_mm).norm(), 1e-4);
}

}  // namespace
}  // namespace lumifield
