// Scans whose frames are kept: what that takes is told before, and that it cannot go on when it happens.
#include "app/session/scan_recording.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <map>

#include "acquisition/cameras/frame_folder.h"
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

/// Something happens before an exposure.
class Eventful final : public Camera {
 public:
  Eventful(std::unique_ptr<Camera> camera, int exposure, std::function<void()> event)
      : camera_(std::move(camera)), left_(exposure), event_(std::move(event)) {}
  const CameraInfo& info() const override { return camera_->info(); }
  void tell_place(const Vec2& stage_mm) override { camera_->tell_place(stage_mm); }
  Result<RawImage> expose(double exposure_s) override {
    if (--left_ == 0) event_();
    return camera_->expose(exposure_s);
  }
  int frames_retaken() const override { return camera_->frames_retaken(); }

 private:
  std::unique_ptr<Camera> camera_;
  int left_;
  std::function<void()> event_;
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

/// Sees another light at every place, but none in the dark.
class Varied final : public Camera {
 public:
  explicit Varied(std::unique_ptr<Camera> camera) : camera_(std::move(camera)) {}
  const CameraInfo& info() const override { return camera_->info(); }
  void tell_place(const Vec2& stage_mm) override { place_mm_ = stage_mm; }
  Result<RawImage> expose(double exposure_s) override {
    Result<RawImage> image = camera_->expose(exposure_s);
    if (image && image->dn.front() > 64)
      for (std::uint16_t& dn : image->dn)
        dn = static_cast<std::uint16_t>(dn + std::lround(300 + 2 * place_mm_.x() + 3 * place_mm_.y()));
    return image;
  }
  int frames_retaken() const override { return camera_->frames_retaken(); }

 private:
  std::unique_ptr<Camera> camera_;
  Vec2 place_mm_{0, 0};
};

using Cells = std::map<CellIndex, std::vector<float>>;

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

  /// The cells that it stores.
  Cells scanned() {
    Cells cells;
    scan([&](const SessionEvent& event) { keep(cells, event); });
    return cells;
  }
  static void keep(Cells& cells, const SessionEvent& event) {
    if (const auto* cell = std::get_if<CellStored>(&event)) cells[cell->entry.cell] = cell->image->value;
  }
  /// Those before the operator stops it, in the second pass of the fourth cell.
  Cells stopped_scan() {
    doubles_.hold_exposures(true);
    Cells cells;
    auto session = ScanSession::start(request_);
    EXPECT_TRUE(session) << session.error().message();
    if (!session) return cells;
    stop_ = [&session] { (*session)->stop(); };
    doubles_.hold_exposures(false);
    while (auto event = (*session)->next_event()) keep(cells, *event);
    const auto summary = (*session)->wait();
    EXPECT_EQ(summary ? ErrorKind::fault : summary.error().kind, ErrorKind::stopped);
    return cells;
  }
  void at_exposure(int exposure, const std::function<void()>& event) {
    request_.devices.camera = [open = request_.devices.camera, exposure, event](const CameraSettings& settings) {
      auto camera = open(settings);
      if (camera) *camera = std::make_unique<Eventful>(std::move(*camera), exposure, event);
      return camera;
    };
  }
  void vary_the_light() {
    request_.devices.camera = [open = request_.devices.camera](const CameraSettings& settings) {
      auto camera = open(settings);
      if (camera) *camera = std::make_unique<Varied>(std::move(*camera));
      return camera;
    };
  }
  /// From now on the bench of a recording.
  void play(const fs::path& folder, const char* out) {
    const auto bench = read_bench(folder / "bench.json");
    ASSERT_TRUE(bench) << bench.error().message();
    request_.bench = *bench;
    request_.devices = {};
    request_.recording.reset();
    request_.resume = false;
    request_.out = folder_ / out;
  }
  std::string refusal(const fs::path& folder) {
    const auto recording = record_frames(request_, folder);
    return recording ? "recorded" : recording.error().message();
  }

  test::DoubleBench doubles_{width, height};
  std::function<void()> stop_;
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
  ASSERT_TRUE(record_frames(request_, folder_ / "frames"));
  const Cells recorded = scanned();
  play(folder_ / "frames", "again.lumi");
  EXPECT_EQ(recorded.size(), 6u);
  EXPECT_EQ(scanned(), recorded);
}

TEST_F(ScanRecording, IsPlayedBackWhereverItLies) {
  vary_the_light();
  ASSERT_TRUE(record_frames(request_, folder_ / "frames"));
  const Cells recorded = scanned();
  ASSERT_EQ(recorded.size(), 6u);
  EXPECT_NE(recorded.begin()->second, recorded.rbegin()->second);

  fs::copy(folder_ / "frames", folder_ / "copy");
  support::write_text(folder_ / "frames/000001.pgm", "damaged");
  play(folder_ / "copy", "copied.lumi");
  EXPECT_EQ(scanned(), recorded);
  EXPECT_THAT(support::read_text(folder_ / "copied.lumi/luminaire.json"), HasSubstr((folder_ / "copy").string()));

  fs::remove_all(folder_ / "frames");
  fs::create_directory(folder_ / "elsewhere");
  fs::rename(folder_ / "copy", folder_ / "elsewhere/moved");
  play(folder_ / "elsewhere/moved", "moved.lumi");
  EXPECT_EQ(scanned(), recorded);

  // A scan that was played back from where it lay before goes on with it.
  play(folder_ / "elsewhere/moved", "copied.lumi");
  request_.resume = true;
  request_.retake = {{1, 1}};
  const Cells again = scanned();
  EXPECT_EQ(again, (Cells{{{1, 1}, recorded.at({1, 1})}}));
}

TEST_F(ScanRecording, OfAScanThatIsResumedGoesOn) {
  vary_the_light();
  const fs::path frames = folder_ / "frames";
  const BenchDevices devices = request_.devices;
  constexpr int exposures = 3 * (1 + 1 + 2 * 3) + 4;
  at_exposure(exposures + 1, [this] { stop_(); });
  ASSERT_TRUE(record_frames(request_, frames));
  Cells recorded = stopped_scan();
  ASSERT_EQ(recorded.size(), 3u);
  const std::string before = support::read_text(frames / "frames.csv");
  const auto lines = [](const std::string& text) { return std::ranges::count(text, '\n'); };
  ASSERT_EQ(lines(before), 1 + exposures + 1) << "the one at hand is waited for";
  support::write_text(frames / "frames.csv", before + "0000");  // the power went

  request_.devices = devices;
  request_.resume = true;
  const auto recording = record_frames(request_, frames);
  ASSERT_TRUE(recording) << recording.error().message();
  EXPECT_EQ(support::read_text(frames / "frames.csv"), before);
  recorded.merge(scanned());
  EXPECT_EQ(recorded.size(), 6u);
  const std::string after = support::read_text(frames / "frames.csv");
  EXPECT_TRUE(after.starts_with(before));
  EXPECT_EQ(lines(after), 1 + lines(before) - 1 + 3 * (1 + 2 + 2 * 3));
  EXPECT_EQ(static_cast<std::size_t>(lines(after)), (*recording)->frames() + 1);
  const std::string last = std::to_string((*recording)->frames());
  EXPECT_TRUE(fs::exists(frames / (std::string(6 - last.size(), '0') + last + ".pgm")));

  play(frames, "again.lumi");
  EXPECT_EQ(scanned(), recorded);
}

TEST_F(ScanRecording, GoesOnWithWhatItsBenchBeganOnly) {
  const fs::path frames = folder_ / "frames";
  const Bench bench = request_.bench;
  ASSERT_TRUE(record_frames(request_, frames));
  scanned();
  EXPECT_THAT(refusal(frames), HasSubstr("holds something already; record into another folder"));
  request_.resume = true;
  EXPECT_EQ(refusal(frames), "recorded");
  EXPECT_EQ(refusal(folder_ / "another"), "recorded") << "a folder that is not there is made";
  request_.bench.camera.address = "another port", request_.bench.tolerance_mm *= 2;
  EXPECT_EQ(refusal(frames), "recorded");
  request_.bench.sensor.black_level_dn += 1;
  EXPECT_THAT(refusal(frames), AllOf(HasSubstr("frames: bench: sensor.black_level_dn: is 65.0, but the recording was "
                                               "begun with 64.0"),
                                     HasSubstr("record into another folder")));
  request_.bench = bench;
  support::write_text(frames / "frames.csv", "file,exposure_s\n000001.pgm,1\n");
  EXPECT_THAT(refusal(frames), HasSubstr("frames.csv: is a list that no recording wrote; record into another folder"));
  support::write_text(frames / "frames.csv", frame_list_header() + "000001.pgm,1\n");
  EXPECT_THAT(refusal(frames), HasSubstr("frames.csv, line 2: has 2 columns"));
  request_.bench.camera.address = "another.pgm";
  support::write_text(frames / "bench.json", to_json(request_.bench));
  EXPECT_THAT(refusal(frames), HasSubstr("holds something already")) << "it is no recording's";
  support::write_text(frames / "bench.json", "{");
  EXPECT_THAT(refusal(frames), HasSubstr("frames/bench.json: is no valid JSON"));
  fs::remove(frames / "bench.json");
  EXPECT_THAT(refusal(frames), HasSubstr("holds something already"));
}

TEST_F(ScanRecording, ThatCannotGoOnIsToldAtOnceAndTheScanGoesOn) {
  const auto recorded = folder_ / "frames";
  at_exposure(5, [recorded] { fs::remove_all(recorded); });
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
