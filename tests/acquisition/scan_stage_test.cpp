// Whole scans on the production stage before the virtual controller, judged by where its carriage truly stands.
#include <algorithm>
#include <filesystem>
#include <gtest/gtest.h>
#include <unistd.h>
#include <vector>

#include "acquisition/scan/scanner.h"
#include "acquisition/virtual/grbl_controller.h"
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
    RawImage image;
    image.width_px = image.height_px = 1;
    image.exposure_s = exposure_s;
    image.dn = {static_cast<std::uint16_t>(reading->y() > 85 ? 64 : 1064)};
    return image;
  }

  std::vector<Vec2> off_mm;

 private:
  Stage& stage_;
  const virtual_bench::GrblController& carriage_;
  CameraInfo info_;
};

class Sink final : public ScanSink {
 public:
  void cell(RawCell raw) override { cells.push_back(raw.cell); }
  void reference(const ReferenceReading&) override {}
  void progress(const ScanProgress&) override {}
  void notice(const std::string& text) override { notices.push_back(text); }

  std::vector<CellIndex> cells;
  std::vector<std::string> notices;
};

class ScanOnVirtualStage : public testing::Test {
 protected:
  void SetUp() override {
    options_.path = std::filesystem::temp_directory_path() / ("lumifield-scan-stage-" + std::to_string(getpid()));
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
  Sink sink_;
  std::vector<Vec2> off_mm_;
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

}  // namespace
}  // namespace lumifield
