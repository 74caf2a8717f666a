// Scans whose frames are kept: what that takes is told before, and that it cannot go on when it happens.
#include "app/session/scan_recording.h"

#include <algorithm>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <map>

#include "app/session/prediction.h"
#include "tests/support/dataset_folder.h"
#include "tests/support/double_bench.h"
#include "tests/support/small_bench.h"

namespace lumifield {
namespace {

using testing::AllOf;
using testing::HasSubstr;
namespace fs = std::filesystem;
constexpr int width = 160, height = 120;

/// Takes a folder away before an exposure.
class TakingAway final : public Camera {
 public:
  TakingAway(std::unique_ptr<Camera> camera, fs::path folder, int exposure)
      : camera_(std::move(camera)), folder_(std::move(folder)), left_(exposure) {}
  const CameraInfo& info() const override { return camera_->info(); }
  void tell_place(const Vec2& stage_mm) override { camera_->tell_place(stage_mm); }
  Result<RawImage> expose(double exposure_s) override {
    if (--left_ == 0) fs::remove_all(folder_);
    return camera_->expose(exposure_s);
  }
  int frames_retaken() const override { return camera_->frames_retaken(); }

 private:
  std::unique_ptr<Camera> camera_;
  fs::path folder_;
  int left_;
};

/// Settles off the target, to one side and the other in turn.
class Unsteady final : public Stage {
 public:
  Unsteady(std::unique_ptr<Stage> stage, double off_mm) : stage_(std::move(stage)), off_mm_(off_mm) {}
  const StageInfo& info() const override { return stage_->info(); }
  Status home(std::stop_token stop) override { return stage_->home(stop); }
  Status move_to(const Vec2& target_mm, std::stop_token stop) override {
    off_mm_ = -off_mm_;
    return stage_->move_to(target_mm + Vec2(off_mm_, 0), stop);
  }
  Result<Vec2> position() override { return stage_->position(); }
  void halt() override { stage_->halt(); }

 private:
  std::unique_ptr<Stage> stage_;
  double off_mm_;
};

class ScanRecording : public support::TemporaryFolder {
 protected:
  ScanRecording() {
    request_.bench = test::developed_bench();
    request_.plan = test::developed_plan();
    request_.out = folder_ / "lamp.lumi";
    request_.devices = doubles_.devices();
  }
  /// All events of a scan, and its summary.
  ScanSummary scan(const std::function<void(const SessionEvent&)>& told) {
    auto session = ScanSession::start(request_);
    EXPECT_TRUE(session) << session.error().message();
    if (!session) return {};
    while (auto event = (*session)->next_event()) told(*event);
    const auto summary = (*session)->wait();
    EXPECT_TRUE(summary) << summary.error().message();
    return summary ? *summary : ScanSummary{};
  }

  test::DoubleBench doubles_{width, height};
  ScanRequest request_;
};

TEST_F(ScanRecording, IsPredictedByWhatItTakes) {
  const auto recording = record_frames(request_, folder_ / "frames");
  ASSERT_TRUE(recording) << recording.error().message();
  const ScanSummary summary = scan([](const SessionEvent&) {});
  ASSERT_TRUE(summary.prediction && summary.prediction->recording);
  const RecordingPrediction& told = *summary.prediction->recording;
  EXPECT_TRUE(told.on_same_disk);
  EXPECT_GT(told.free_bytes.value_or(0), 0);
  double took = 0;
  for (const auto& file : fs::directory_iterator(folder_ / "frames"))
    if (file.path().filename() != "bench.json") took += static_cast<double>(file.file_size());
  const auto frames = static_cast<double>((*recording)->frames());
  EXPECT_EQ(frames, 3 * (1 + 2 + 2 * 6)) << "a dark set, two readings, two passes of six cells, three exposures each";
  EXPECT_LE(took, told.bytes);
  EXPECT_GE(took, told.bytes - frames * (4096 + 256));

  // The longer exposures that a scan may take, and the readings of a lamp that warms up, count as well.
  const auto bytes = [&](const Plan& plan) {
    const auto steps = make_scan_plan(request_.bench, plan);
    EXPECT_TRUE(steps) << steps.error().message();
    return predict(request_.bench, plan, *steps, {}, request_.out, folder_).recording->bytes;
  };
  Plan plan = request_.plan;
  plan.exposure_limits_s = ExposureLimits{0.002, 0.128};
  EXPECT_DOUBLE_EQ(bytes(plan), told.bytes * (4 * (1 + 2 * 6) + 3 * 2) / frames);
  plan = request_.plan;
  plan.stabilisation = Stabilisation{0.01, 10, 60};
  EXPECT_DOUBLE_EQ(bytes(plan), told.bytes * (frames + 3 * (60 + 2)) / frames);
}

TEST_F(ScanRecording, OfAStageWithAWideToleranceIsPlayedBack) {
  request_.bench.tolerance_mm = 0.3;
  request_.devices.stage = [open = request_.devices.stage](const StageSettings& settings) {
    auto stage = open(settings);
    if (stage) *stage = std::make_unique<Unsteady>(std::move(*stage), 0.25);
    return stage;
  };
  std::map<CellIndex, std::vector<float>> recorded, played;
  const auto keep = [](std::map<CellIndex, std::vector<float>>& cells) {
    return [&cells](const SessionEvent& event) {
      if (const auto* cell = std::get_if<CellStored>(&event)) cells[cell->entry.cell] = cell->image->value;
    };
  };
  ASSERT_TRUE(record_frames(request_, folder_ / "frames"));
  scan(keep(recorded));
  const auto bench = read_bench(folder_ / "frames/bench.json");
  ASSERT_TRUE(bench) << bench.error().message();
  request_.bench = *bench;
  request_.devices = {};
  request_.recording.reset();
  request_.out = folder_ / "again.lumi";
  scan(keep(played));
  EXPECT_EQ(recorded.size(), 6u);
  EXPECT_EQ(played, recorded);
}

TEST_F(ScanRecording, ThatCannotGoOnIsToldAtOnceAndTheScanGoesOn) {
  const auto recorded = folder_ / "frames";
  request_.devices.camera = [open = request_.devices.camera, recorded](const CameraSettings& settings) {
    auto camera = open(settings);
    if (camera) *camera = std::make_unique<TakingAway>(std::move(*camera), recorded, 5);
    return camera;
  };
  const auto recording = record_frames(request_, recorded);
  ASSERT_TRUE(recording) << recording.error().message();
  std::vector<std::string> order;
  const ScanSummary summary = scan([&](const SessionEvent& event) {
    if (const auto* notice = std::get_if<Notice>(&event); notice && notice->text.starts_with("the recording"))
      order.push_back(notice->text);
    if (std::holds_alternative<ReferenceReading>(event)) order.emplace_back("reading");
  });
  ASSERT_EQ(order.size(), 3u) << "told once";
  EXPECT_THAT(order[0], AllOf(HasSubstr("the recording of the frames ends after 4: "), HasSubstr("000005.pgm: could"),
                              HasSubstr("The scan goes on without it")));
  EXPECT_EQ(order[1], "reading") << "the sixth frame is the first reading's last";
  EXPECT_EQ(summary.coverage.measured, 6);
  EXPECT_EQ(summary.cells_with_warnings, 0);
  EXPECT_TRUE((*recording)->error());
}

}  // namespace
}  // namespace lumifield
