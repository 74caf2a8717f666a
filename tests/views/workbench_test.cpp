#include "app/views/workbench.h"

#include <QSignalSpy>
#include <QTemporaryDir>
#include <QTest>
#include <fstream>
#include <gtest/gtest.h>

#include "tests/support/double_bench.h"
#include "tests/support/small_bench.h"

namespace lumifield {
namespace {

constexpr int patience_ms = 60'000;
constexpr int width = 160, height = 120;

/// What every check before a scan lets pass.
std::string bench_file() {
  Bench bench = test::developed_bench();
  bench.camera.readout_s = 0;
  bench.camera.address = bench.stage.path = "in this process";
  return to_json(bench);
}

std::string plan_file() { return to_json(test::developed_plan()); }

/// The rules between opening and scanning, on a bench of doubles; the render thread has no scene and makes no picture.
class WorkbenchTest : public testing::Test {
 protected:
  WorkbenchTest() {
    std::ofstream(path("bench.json")) << bench_file();
    std::ofstream(path("plan.json")) << plan_file();
    QObject::connect(&work, &Workbench::noticed, &work, [this](const OperatorNotice& notice) {
      notices << notice.text;
      if (notice.level == OperatorNotice::Level::fault) ++faults;
    });
  }
  ~WorkbenchTest() override {
    bench.hold_opening(false);
    bench.hold_exposures(false);
  }

  std::filesystem::path path(const char* name) const { return place.filePath(name).toStdString(); }
  /// A dataset with as many cells as told, each of this value.
  void write(const char* name, int cells) {
    Manifest manifest;
    manifest.name = name;
    manifest.geometry.planes.separation_mm = 150;
    manifest.geometry.sampling = {BasisKind::bell, {7.5, 7.5}, 3, 2, {0, 0}};
    manifest.geometry.measurement = {24, 18, {4, 4}, {0, 0}};
    manifest.geometry.channels = {"Y"};
    auto writer = DatasetWriter::create(path(name), manifest);
    ASSERT_TRUE(writer) << writer.error().message();
    for (int k = 0; k < cells; ++k)
      ASSERT_TRUE(
          writer->add(manifest.geometry.sampling.index(k), {24, 18, 1, std::vector<float>(432, 1), {}, {}}, {0, 0}));
  }
  void prepare(const char* out) {
    QSignalSpy prepared(&work, &Workbench::prepared);
    work.prepare(path("bench.json"), path("plan.json"), path(out));
    ASSERT_TRUE(QTest::qWaitFor([&] { return prepared.count() == 1; }, patience_ms)) << qPrintable(notices.join("\n"));
  }
  template <class Condition>
  [[nodiscard]] bool comes(Condition condition) {
    return QTest::qWaitFor(condition, patience_ms);
  }
  /// While the first luminaire loads.
  void at_the_first_cell(std::function<void()> act) {
    QObject::connect(&work.model(), &LuminaireModel::cellLoaded, &work, [this, act = std::move(act)] {
      if (std::exchange(acted, true)) return;
      ASSERT_TRUE(work.model().loading());
      act();
    });
  }
  bool idle() {
    return comes([&] { return work.scan().activity() == ScanActivity::idle; });
  }
  bool watched() {
    return comes([&] { return work.scan().bench_view()->snapshot().place == "live"; });
  }

  QTemporaryDir place;
  test::DoubleBench bench{width, height};
  LivePreview preview{{}};
  Workbench work{preview, bench.devices()};
  QStringList notices;
  int faults = 0;
  bool acted = false;
};

TEST_F(WorkbenchTest, TheWatchHandsTheDevicesToTheScanAndTakesThemBack) {
  prepare("new.lumi");
  ASSERT_TRUE(watched());
  EXPECT_EQ(work.why_not_start(), QString());
  bench.hold_exposures(true);  // the scan waits for the watch's exposure, this thread does not
  work.start();
  EXPECT_EQ(work.scan().activity(), ScanActivity::starting);
  bench.hold_exposures(false);
  ASSERT_TRUE(idle()) << qPrintable(notices.join("\n"));
  EXPECT_EQ(faults, 0) << qPrintable(notices.join("\n"));
  EXPECT_EQ(work.model().measured(), 6);
  EXPECT_TRUE(comes([&] { return bench.cameras_opened() == 3; })) << "watch, scan, watch";
  EXPECT_EQ(bench.most_cameras_at_once(), 1);
  EXPECT_EQ(bench.most_stages_at_once(), 1);
}

TEST_F(WorkbenchTest, ASlideIsAskedForAndAScanThatWasStoppedThereGoesOn) {
  Bench by_hand = *parse_bench(bench_file(), "bench.json");
  by_hand.filter.change = PassChange::by_operator;
  std::ofstream(path("bench.json")) << to_json(by_hand);
  prepare("new.lumi");
  const auto asked = [&] { return work.scan().activity() == ScanActivity::paused; };
  work.start();
  ASSERT_TRUE(comes(asked));
  EXPECT_EQ(work.scan().progress().slide, "negative");
  EXPECT_TRUE(notices.contains(
      "Paused: slide: the pass 'positive' is taken; put in the slide 'negative', then go on with Resume (F6)."))
      << qPrintable(notices.join("\n"));
  EXPECT_EQ(work.model().measured(), 0);
  work.scan().stop();
  ASSERT_TRUE(idle());
  EXPECT_EQ(work.why_not_start(), QString());

  // These filters read alike, so that the slide is doubted once.
  work.start();
  ASSERT_TRUE(comes(asked));
  EXPECT_TRUE(notices.last().contains("it reads as through 'positive'")) << qPrintable(notices.last());
  work.scan().resume();
  ASSERT_TRUE(idle());
  EXPECT_EQ(work.model().measured(), 6);
  EXPECT_EQ(faults, 0) << qPrintable(notices.join("\n"));
}

TEST_F(WorkbenchTest, AScansBracketsAreCopiedWhileTheyAreWatched) {
  const std::shared_ptr<BenchView>& view = work.scan().bench_view();
  for (const bool watched : {false, true}) {
    view->set_watched(watched);
    const char* out = watched ? "watched.lumi" : "unwatched.lumi";
    prepare(out);
    bench.hold_exposures_after(30);  // after a dark set, the reference and some cells
    work.start();
    ASSERT_TRUE(comes([&] { return work.folder() == path(out) && work.model().measured() >= 1; }));
    EXPECT_EQ(view->snapshot().place.starts_with("cell ("), watched) << view->snapshot().place;
    bench.hold_exposures(false);
    ASSERT_TRUE(idle());
  }
}

TEST_F(WorkbenchTest, NoDatasetIsOpenedWhileAScanStarts) {
  write("other.lumi", 2);
  prepare("new.lumi");
  bench.hold_opening(true);
  work.start();
  work.open(path("other.lumi"));
  ASSERT_EQ(notices.size(), 1);
  EXPECT_TRUE(notices[0].contains("is not opened while a scan runs")) << qPrintable(notices[0]);
  bench.hold_opening(false);
  ASSERT_TRUE(idle());
  EXPECT_EQ(work.folder(), path("new.lumi"));
  EXPECT_EQ(work.model().measured(), 6);
}

TEST_F(WorkbenchTest, RetakesAskedForWhileAScanStartsAreTaken) {
  prepare("new.lumi");
  work.start();
  ASSERT_TRUE(idle());
  ASSERT_EQ(work.model().measured(), 6);
  bench.hold_opening(true);
  work.retake({{0, 1}});
  EXPECT_EQ(work.scan().activity(), ScanActivity::starting);
  work.retake({{1, 2}});
  EXPECT_EQ(work.model().state({1, 2}), LuminaireModel::State::waiting);
  bench.hold_opening(false);
  ASSERT_TRUE(idle());
  for (const CellIndex cell : {CellIndex{0, 1}, CellIndex{1, 2}})
    EXPECT_EQ(work.model().cell(cell)->entry.generation, 2) << to_string(cell);
  EXPECT_EQ(work.model().cell({0, 0})->entry.generation, 1);
  EXPECT_EQ(work.model().state({1, 2}), LuminaireModel::State::measured);
}

TEST_F(WorkbenchTest, ARehearsalTakesTheDevicesTellsAndGivesThemBack) {
  prepare("new.lumi");
  ASSERT_TRUE(watched());
  QSignalSpy rehearsed(&work.scan(), &ScanController::rehearsed), progressed(&work.scan(), &ScanController::progressed);
  bench.hold_exposures(true);  // the rehearsal waits for the watch's exposure, this thread does not
  work.rehearse();
  EXPECT_EQ(work.scan().activity(), ScanActivity::rehearsing);
  work.rehearse();
  work.start();
  work.retake({{0, 0}});
  EXPECT_EQ(work.scan().activity(), ScanActivity::rehearsing);
  EXPECT_EQ(work.model().measured(), 0);
  bench.hold_exposures(false);
  ASSERT_TRUE(comes([&] { return rehearsed.count() == 1; }));
  EXPECT_EQ(work.scan().activity(), ScanActivity::idle);
  EXPECT_GT(progressed.count(), 8);
  EXPECT_EQ(faults, 0);
  EXPECT_TRUE(notices.last().contains("8 corner places reached; test shot of cell (1, 1): brightest pixel at 42 %"))
      << qPrintable(notices.last());
  EXPECT_TRUE(notices.last().contains("the scan: 6 cells, about"));
  EXPECT_FALSE(std::filesystem::exists(path("new.lumi"))) << "nothing is stored";
  EXPECT_EQ(bench.most_cameras_at_once(), 1);
  EXPECT_TRUE(watched());
  work.start();
  ASSERT_TRUE(idle());
  EXPECT_EQ(work.model().measured(), 6);
}

TEST_F(WorkbenchTest, ARehearsalIsStoppedAndTellsItsTroubles) {
  prepare("new.lumi");
  ASSERT_TRUE(watched());
  bench.hold_exposures_after(1);
  work.rehearse();
  work.scan().stop();
  EXPECT_EQ(work.scan().activity(), ScanActivity::stopping);
  bench.hold_exposures(false);
  ASSERT_TRUE(idle());
  EXPECT_TRUE(notices.last().contains("The rehearsal was stopped")) << qPrintable(notices.last());

  ASSERT_TRUE(watched());
  bench.trip_stage_after(3);
  work.rehearse();
  ASSERT_TRUE(idle());
  EXPECT_EQ(faults, 1);
  EXPECT_TRUE(notices.last().contains("The rehearsal failed: corner cell (1, 2), pass positive: stage: alarm 1"))
      << qPrintable(notices.last());
}

TEST_F(WorkbenchTest, AScanPreparedDuringALoadCounts) {
  write("other.lumi", 2);
  work.open(path("other.lumi"));
  prepare("new.lumi");
  ASSERT_TRUE(comes([&] { return !work.model().loading(); }));
  QTest::qWait(0);
  ASSERT_TRUE(work.request());
  EXPECT_EQ(work.request()->out, path("new.lumi"));
  work.start();
  ASSERT_TRUE(comes([&] { return work.folder() == path("new.lumi"); }));
  ASSERT_TRUE(idle());
  EXPECT_EQ(work.model().measured(), 6);
}

TEST_F(WorkbenchTest, AScanStartedDuringItsLoadGoesOnWithWhatIsThere) {
  prepare("half.lumi");
  bench.hold_exposures_after(30);  // after a dark set, the reference and some cells
  work.start();
  ASSERT_TRUE(comes([&] { return work.model().measured() >= 1; }));
  work.scan().stop();
  bench.hold_exposures(false);
  ASSERT_TRUE(idle());
  const int before = work.model().measured();
  ASSERT_LT(before, 6);

  prepare("half.lumi");
  EXPECT_TRUE(work.model().loading());
  work.start();
  EXPECT_EQ(work.scan().activity(), ScanActivity::idle) << "the load comes first";
  ASSERT_TRUE(comes([&] { return work.scan().busy(); }));
  EXPECT_EQ(work.model().measured(), before);
  ASSERT_TRUE(idle());
  EXPECT_EQ(work.model().measured(), 6);
  for (int k = 0; k < 6; ++k)
    EXPECT_EQ(work.model().cell(work.model().geometry()->sampling.index(k))->entry.generation, 1);
}

TEST_F(WorkbenchTest, WhatCannotBeOpenedLeavesALoadThatGoesOn) {
  write("whole.lumi", 6);
  at_the_first_cell([&] { work.open(path("none.lumi")); });
  work.open(path("whole.lumi"));
  ASSERT_TRUE(comes([&] { return faults == 1 && !work.model().loading(); }));
  EXPECT_EQ(work.folder(), path("whole.lumi"));
  EXPECT_EQ(work.model().measured(), 6);
}

TEST_F(WorkbenchTest, AScanThatWaitedForWhatCannotBeOpenedGoesOn) {
  prepare("new.lumi");
  work.start();
  ASSERT_TRUE(idle());
  work.open(path("none.lumi"));
  work.retake({{0, 1}});
  EXPECT_EQ(work.scan().activity(), ScanActivity::idle) << "the opening comes first";
  ASSERT_TRUE(comes([&] { return faults == 1 && work.scan().busy(); }));
  ASSERT_TRUE(idle());
  EXPECT_EQ(work.model().cell({0, 1})->entry.generation, 2);
}

TEST_F(WorkbenchTest, OfLuminairesOpenedAtOnceTheLastIsShown) {
  write("a.lumi", 6);
  write("b.lumi", 3);
  at_the_first_cell([&] {
    work.open(path("a.lumi"));
    work.open(path("b.lumi"));
  });
  work.open(path("a.lumi"));
  ASSERT_TRUE(comes([&] { return work.folder() == path("b.lumi") && !work.model().loading(); }));
  EXPECT_EQ(work.model().measured(), 3);
  EXPECT_EQ(faults, 0);
}

TEST_F(WorkbenchTest, ATroublePausesTheScanSaysWhyAndIsOverOnTheOperatorsWord) {
  prepare("tripped.lumi");
  ASSERT_TRUE(watched());
  bench.trip_stage_after(5);  // dark set, reference, into the cells
  work.start();
  ASSERT_TRUE(comes([&] { return work.scan().activity() == ScanActivity::paused; })) << qPrintable(notices.join("\n"));
  EXPECT_EQ(faults, 1);
  EXPECT_TRUE(notices.last().contains("a limit switch was hit; home it")) << qPrintable(notices.last());
  EXPECT_TRUE(QString::fromStdString(work.scan().progress().trouble).contains("alarm 1"));
  const int opened = bench.stages_opened();
  work.scan().resume();
  ASSERT_TRUE(idle()) << qPrintable(notices.join("\n"));
  EXPECT_TRUE(comes([&] { return bench.stages_opened() == opened + 2; })) << "the scan, and the watch after it";
  EXPECT_EQ(bench.most_stages_at_once(), 1);
  EXPECT_EQ(work.model().measured(), work.model().total());
  EXPECT_EQ(faults, 1);
}

}  // namespace
}  // namespace lumifield
