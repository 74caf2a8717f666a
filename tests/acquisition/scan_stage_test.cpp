// Whole scans on the production stage before the virtual controller, judged by where its carriage truly stands.
#include <algorithm>
#include <filesystem>
#include <functional>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <map>
#include <unistd.h>
#include <vector>

#include "acquisition/scan/scanner.h"
#include "acquisition/virtual/grbl_controller.h"
#include "tests/support/scripted_grbl.h"
#include "tests/support/small_bench.h"

namespace lumifield {
namespace {

/// Keeps how far the carriage stands from where the stage says, at every exposure.
class WatchingCamera final : public Camera {
 public:
  WatchingCamera(Stage& stage, const virtual_bench::GrblController& carriage) : stage_(stage), carriage_(carriage) {}
  const CameraInfo& info() const override { return info_; }
  int frames_retaken() const override { return 0; }
  Result<RawImage> expose(double exposure_s) override {
    const Result<Vec2> reading = stage_.position();
    if (!reading) return tl::unexpected(reading.error());
    off_mm.push_back(carriage_.true_position_mm() - *reading);
    if (on_exposure) on_exposure(off_mm.size());
    RawImage image;
    image.width_px = image.height_px = 1;
    image.exposure_s = exposure_s;
    image.frame_id = off_mm.size() - 1;
    image.dn = {static_cast<std::uint16_t>(reading->y() > 85 ? 64 : 1064)};
    return image;
  }

  std::vector<Vec2> off_mm;
  std::function<void(std::size_t frames)> on_exposure;

 private:
  Stage& stage_;
  const virtual_bench::GrblController& carriage_;
  CameraInfo info_;
};

class Sink final : public ScanSink {
 public:
  void cell(RawCell raw) override { cells.push_back(std::move(raw)); }
  void reference(const ReferenceReading&) override {}
  void progress(const ScanProgress&) override {}
  void notice(const std::string& text) override { notices.push_back(text); }

  std::vector<RawCell> cells;
  std::vector<std::string> notices;
};

class ScanOnVirtualStage : public testing::Test {
 protected:
  void SetUp() override {
    options_.path = std::filesystem::temp_directory_path() / ("lumifield-scan-stage-" + std::to_string(getpid()));
    options_.soft_limits = options_.hard_limits = false;
    options_.rapid_mm_s = 2000;
    options_.acceleration_mm_s2 = 50'000;
    auto controller = virtual_bench::GrblController::start(options_);
    ASSERT_TRUE(controller) << controller.error().message();
    controller_ = std::move(*controller);
    bench_.stage.path = options_.path;
    bench_.limits = {{0, 0}, options_.travel_mm};
    bench_.stage_to_luminaire.origin_mm = {-40, -40};  // the lamp's middle is at (40, 40)
    plan_.settle_s = 0;
    plan_.exposures_s = {0.001};
  }

  Status scan() {
    auto stage = open_stage(bench_.stage);
    if (!stage) return tl::unexpected(stage.error());
    WatchingCamera camera(**stage, *controller_);
    const Result<ScanPlan> steps = make_scan_plan(bench_, plan_);
    if (!steps) return tl::unexpected(steps.error());
    Scanner scanner(camera, **stage, bench_, plan_);
    if (on_exposure_) camera.on_exposure = on_exposure_;
    const Status status = scanner.run(*steps, sink_, {});
    off_mm_ = std::move(camera.off_mm);
    return status;
  }
  double worst_off_mm() const {
    double worst = 0;
    for (const Vec2& off : off_mm_) worst = std::max(worst, off.norm());
    return worst;
  }

  virtual_bench::GrblOptions options_;
  std::unique_ptr<virtual_bench::GrblController> controller_;
  Bench bench_ = test::small_bench();
  Plan plan_ = test::small_plan();
  /// Of the cells that count, each taken last.
  double worst_kept_mm() const {
    std::map<CellIndex, double> worst;
    for (const RawCell& cell : sink_.cells) {
      worst[cell.cell] = 0;
      for (const RawPass& pass : cell.passes)
        for (const RawImage& frame : pass.bracket)
          worst[cell.cell] = std::max(worst[cell.cell], off_mm_[frame.frame_id].norm());
    }
    EXPECT_EQ(worst.size(), 6U);
    return std::ranges::max_element(worst, {}, [](const auto& each) { return each.second; })->second;
  }

  Sink sink_;
  std::vector<Vec2> off_mm_;
  std::function<void(std::size_t frames)> on_exposure_;
};

TEST_F(ScanOnVirtualStage, BacklashShiftsWhatIsComeToFromEitherSide) {
  controller_->set_backlash(0.1);
  const Status scanned = scan();
  ASSERT_TRUE(scanned) << scanned.error().message();
  for (int axis : {0, 1}) {
    const auto [least, most] = std::ranges::minmax(off_mm_, {}, [axis](const Vec2& off) { return off[axis]; });
    EXPECT_NEAR(least[axis], 0, 0.005);
    EXPECT_NEAR(most[axis], 0.1, 0.005);
  }
}

TEST_F(ScanOnVirtualStage, TheApproachKeepsBacklashOut) {
  controller_->set_backlash(0.1);
  bench_.stage.approach_mm = {0.5, 0.5};
  const Status scanned = scan();
  ASSERT_TRUE(scanned) << scanned.error().message();
  EXPECT_EQ(sink_.cells.size(), 6U);
  EXPECT_LE(worst_off_mm(), 0.005) << "a step of 1/250 mm";
}

TEST_F(ScanOnVirtualStage, NoCellThatCountsWasExposedWhereLostStepsLeftTheStage) {
  bench_.stage.check_home = true;
  plan_.dark_every_cells = 2;
  on_exposure_ = [this](std::size_t frames) { controller_->lose_steps(frames >= 9 && frames < 12 ? 0.06 : 0); };
  const Status scanned = scan();
  ASSERT_TRUE(scanned) << scanned.error().message();
  EXPECT_GT(worst_off_mm(), bench_.tolerance_mm) << "some were exposed there, as no reading shows it";
  EXPECT_LE(worst_kept_mm(), bench_.tolerance_mm);
  EXPECT_GT(sink_.cells.size(), 6U);
  EXPECT_FALSE(sink_.notices.empty());
}

TEST_F(ScanOnVirtualStage, ThatLosesStepsAllTheTimeEndsWithTheReason) {
  bench_.stage.check_home = true;
  controller_->lose_steps(0.06);
  const Status scanned = scan();
  ASSERT_FALSE(scanned);
  EXPECT_EQ(scanned.error().where, "home switches");
  EXPECT_TRUE(sink_.cells.empty()) << "found before the first reading of the reference cell was believed";
}

struct FaultCase {
  ScriptedGrbl::Fault fault;
  const char *name, *words;
};

class ScanOnFaultyStage : public testing::TestWithParam<FaultCase> {};
INSTANTIATE_TEST_SUITE_P(Faults, ScanOnFaultyStage,
                         testing::Values(FaultCase{ScriptedGrbl::Fault::silence, "silence", "no answer within 5 s"},
                                         FaultCase{ScriptedGrbl::Fault::garbage, "garbage", "unreadable answers"},
                                         FaultCase{ScriptedGrbl::Fault::alarm, "alarm", "a limit switch was hit"},
                                         FaultCase{ScriptedGrbl::Fault::unplug, "unplug", "unplugged or switched off"}),
                         [](const auto& each) { return std::string(each.param.name); });

TEST_P(ScanOnFaultyStage, PausesSaysWhyAndExposesNothingMore) {
  ScriptedGrbl::Script script;
  script.speed_mm_s = 5000;
  ScriptedGrbl grbl(script);
  Bench bench = test::small_bench();
  bench.stage.path = grbl.path();
  bench.limits = {{0, 0}, {200, 150}};
  bench.stage_to_luminaire.origin_mm = {-40, -40};
  Plan plan = test::small_plan();
  plan.settle_s = 0;
  const auto stage = open_stage(bench.stage);
  ASSERT_TRUE(stage) << stage.error().message();
  const auto steps = make_scan_plan(bench, plan);
  ASSERT_TRUE(steps) << steps.error().message();
  grbl.set_fault(GetParam().fault, 300);

  struct LitCamera final : Camera {
    const CameraInfo& info() const override { return camera_info; }
    int frames_retaken() const override { return 0; }
    Result<RawImage> expose(double exposure_s) override {
      RawImage image;
      image.width_px = image.height_px = 1;
      image.exposure_s = exposure_s;
      image.dn = {static_cast<std::uint16_t>(++frames <= 3 ? 64 : 1064)};  // the dark set comes first
      return image;
    }
    CameraInfo camera_info;
    int frames = 0;
  } camera;
  struct PausedSink final : ScanSink {
    void cell(RawCell) override {}
    void reference(const ReferenceReading&) override {}
    void notice(const std::string&) override {}
    void progress(const ScanProgress& progress) override {
      if (progress.state == ScanState::paused) on_pause(progress.trouble);
    }
    std::function<void(const std::string&)> on_pause;
  } sink;
  std::stop_source stop;
  std::vector<std::string> troubles;
  int frames = 0;
  sink.on_pause = [&](const std::string& trouble) {
    troubles.push_back(trouble);
    frames = camera.frames;
    stop.request_stop();
  };
  ScanControl control;
  control.attend();
  Scanner scanner(camera, **stage, bench, plan);
  scanner.obey(control);
  EXPECT_FALSE(scanner.run(*steps, sink, stop.get_token()));
  ASSERT_EQ(troubles.size(), 1U);
  EXPECT_THAT(troubles[0], testing::AllOf(testing::HasSubstr(GetParam().words), testing::HasSubstr("cell (")));
  EXPECT_GT(frames, 3);
  EXPECT_EQ(camera.frames, frames);
  EXPECT_EQ(scanner.state(), ScanState::stopped);
}

}  // namespace
}  // namespace lumifield
