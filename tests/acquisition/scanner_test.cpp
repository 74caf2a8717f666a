#include "acquisition/scan/scanner.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <set>

#include "tests/support/bench_doubles.h"
#include "tests/support/small_bench.h"

namespace lumifield {
namespace {

using enum ScanState;
using test::CameraDouble;
using test::ManualClock;
using test::StageDouble;
using ::testing::HasSubstr;

class RecordingSink final : public ScanSink {
 public:
  explicit RecordingSink(ManualClock& manual_clock) : clock(manual_clock) {}
  void cell(RawCell raw) override {
    cells.push_back(std::move(raw));
    clock.now += busy_s;
  }
  void reference(const ReferenceReading& reading) override { references.push_back(reading); }
  void progress(const ScanProgress& progress) override {
    reports.push_back(progress);
    if (on_progress) on_progress(progress);
  }
  std::vector<ScanState> states() const {
    std::vector<ScanState> states;
    for (const ScanProgress& report : reports) states.push_back(report.state);
    return states;
  }

  ManualClock& clock;
  double busy_s = 0;
  std::function<void(const ScanProgress&)> on_progress;
  std::vector<RawCell> cells;
  std::vector<ReferenceReading> references;
  std::vector<ScanProgress> reports;
};

/// Six cells, two passes, three exposures each; the lamp shines but behind the opaque patch.
class ScannerTest : public ::testing::Test {
 protected:
  ScannerTest() {
    camera.signal_dn_per_s = [this](const Vec2& at) { return at.y() > 45 ? 0.0 : lamp_dn_per_s; };
  }

  /// Leaves out all but one cell.
  static std::set<CellIndex> all_but(CellIndex kept) {
    std::set<CellIndex> done;
    for (int row = 0; row < 2; ++row)
      for (int column = 0; column < 3; ++column) done.insert({row, column});
    done.erase(kept);
    return done;
  }

  Status run(const std::set<CellIndex>& done = {}) {
    const auto steps = make_scan_plan(bench, plan, done);
    EXPECT_TRUE(steps) << steps.error().message();
    return scanner.run(*steps, sink, stop.get_token());
  }

  ManualClock clock;
  StageDouble stage{clock};
  CameraDouble camera{clock, stage};
  double lamp_dn_per_s = 20'000;
  Bench bench = test::small_bench();
  Plan plan = test::small_plan();
  RecordingSink sink{clock};
  std::stop_source stop;
  Scanner scanner{camera, stage, bench, plan, clock};
};

TEST(ScanStates, FollowTheDrawing) {
  const std::set<std::pair<ScanState, ScanState>> arrows{
      {idle, homing},        {idle, moving},       {idle, done},       {homing, moving},       {moving, settling},
      {settling, moving},    {settling, exposing}, {exposing, moving}, {exposing, delivering}, {delivering, moving},
      {delivering, parking}, {parking, done},      {moving, parking},  {settling, parking},    {exposing, parking}};
  const std::vector<ScanState> all{idle,       homing,  moving, settling, exposing,
                                   delivering, parking, done,   stopped,  failed};
  for (const ScanState from : all)
    for (const ScanState to : all) {
      const bool ends = !is_final(from) && (to == stopped || to == failed);
      EXPECT_EQ(can_follow(from, to), ends || arrows.contains({from, to})) << to_string(from) << " → " << to_string(to);
    }
}

TEST_F(ScannerTest, WalksOneCellThroughTheStates) {
  EXPECT_EQ(scanner.state(), idle);
  ASSERT_TRUE(run(all_but({0, 0})));
  EXPECT_EQ(sink.states(), (std::vector<ScanState>{homing,                                   //
                                                   moving,  settling, exposing, delivering,  // dark
                                                   moving,  settling, exposing, delivering,  // reference
                                                   moving,  settling, exposing,              // positive
                                                   moving,  settling, exposing, delivering,  // negative
                                                   moving,  settling, exposing, delivering,  // reference
                                                   parking, done}));
  EXPECT_EQ(scanner.state(), done);
  EXPECT_EQ(stage.homings, 1);
  EXPECT_EQ(stage.halts, 0);
  EXPECT_EQ(stage.at, dark_target_mm(bench));
}

TEST_F(ScannerTest, RunsOnceOnly) {
  Status nested;
  sink.on_progress = [&](const ScanProgress& progress) {
    if (progress.state == exposing) nested = scanner.run({}, sink, {});
  };
  ASSERT_TRUE(run());
  ASSERT_FALSE(nested);
  EXPECT_THAT(nested.error().what, HasSubstr("begun already: exposing"));
  const Status again = run();
  ASSERT_FALSE(again);
  EXPECT_THAT(again.error().what, HasSubstr("begun already: done"));
  EXPECT_EQ(scanner.state(), done);
}

TEST_F(ScannerTest, RefusesStepsThatDoNotOpenWithADarkSet) {
  auto steps = make_scan_plan(bench, plan);
  ASSERT_TRUE(steps);
  steps->steps.erase(steps->steps.begin());
  const Status status = scanner.run(*steps, sink, {});
  ASSERT_FALSE(status);
  EXPECT_THAT(status.error().what, HasSubstr("not a dark set"));
  EXPECT_EQ(scanner.state(), idle);
  EXPECT_EQ(stage.moves, 0);
}

TEST_F(ScannerTest, HasNothingToDoWhenAllCellsAreDone) {
  ASSERT_TRUE(scanner.run({}, sink, {}));
  EXPECT_EQ(scanner.state(), done);
  EXPECT_EQ(stage.moves + stage.homings + camera.frames, 0);
}

TEST_F(ScannerTest, DeliversWholeCellsInTheBenchsPassOrder) {
  stage.off_by_mm = {0.006, -0.008};  // within the tolerance of 0.02
  stage.off_from_move = 1, stage.off_until_move = 1000;
  ASSERT_TRUE(run());
  ASSERT_EQ(sink.cells.size(), 6U);
  for (const RawCell& raw : sink.cells) {
    ASSERT_EQ(raw.passes.size(), 2U);
    EXPECT_NEAR(raw.position_error_mm, 0.01, 1e-12);
    for (std::size_t p = 0; p < 2; ++p) {
      const Vec2 u((raw.cell.column - 1) * 7.5, (raw.cell.row - 0.5) * 7.5);
      const Vec2 read_back = u + bench.filter.passes[p].offset_mm + stage.off_by_mm;
      EXPECT_EQ(raw.passes[p].name, bench.filter.passes[p].name);
      EXPECT_LT((raw.passes[p].stage_mm - read_back).norm(), 1e-12);
      ASSERT_EQ(raw.passes[p].bracket.size(), 3U);
      for (std::size_t e = 0; e < 3; ++e) {
        EXPECT_EQ(raw.passes[p].bracket[e].exposure_s, plan.exposures_s[e]);
        EXPECT_EQ(raw.passes[p].bracket[e].stage_mm, raw.passes[p].stage_mm);
      }
    }
  }
}

TEST_F(ScannerTest, HandsEveryCellTheDarkSetOfItsBlock) {
  plan.dark_every_cells = 4;
  ASSERT_TRUE(run());
  for (std::size_t n = 0; n < 6; ++n) {
    ASSERT_TRUE(sink.cells[n].dark);
    EXPECT_EQ(sink.cells[n].dark->block, n < 4 ? 0 : 1);
    EXPECT_EQ(sink.cells[n].dark, sink.cells[n < 4 ? 0 : 4].dark);
    ASSERT_EQ(sink.cells[n].dark->bracket.size(), 3U);
    EXPECT_EQ(sink.cells[n].dark->bracket[2].dn[0], 64);
    EXPECT_EQ(sink.cells[n].dark->bracket[2].stage_mm, dark_target_mm(bench));
  }
}

TEST_F(ScannerTest, FollowsTheLampsDrift) {
  plan.reference.every = 2;
  sink.on_progress = [&](const ScanProgress& progress) { lamp_dn_per_s = 20'000 * (1 + 0.1 * progress.cells_done); };
  ASSERT_TRUE(run());
  ASSERT_EQ(sink.references.size(), 4U);
  // 4095 DN are reached above 0.2 s, so that the longest exposure serves: 640 DN at 0.032 s.
  for (std::size_t n = 0; n < 4; ++n) {
    EXPECT_EQ(sink.references[n].cells_done, static_cast<int>(2 * n));
    EXPECT_NEAR(sink.references[n].drift, 0.2 * static_cast<double>(n), 1e-9);
    EXPECT_NEAR(sink.references[n].signal_dn_per_s, 20'000 * (1 + 0.2 * static_cast<double>(n)), 1e-6);
  }
  for (std::size_t n = 0; n < 6; ++n) EXPECT_EQ(sink.cells[n].drift, sink.references[n / 2].drift);
}

TEST_F(ScannerTest, ReferenceTakesTheLongestExposureThatDoesNotSaturate) {
  lamp_dn_per_s = 200'000;  // 6400 DN at 0.032 s, 1600 at 0.008 s
  ASSERT_TRUE(run());
  EXPECT_NEAR(sink.references[0].signal_dn_per_s, 200'000, 1e-6);
}

TEST_F(ScannerTest, ReferenceThatSaturatesEverywhereFails) {
  lamp_dn_per_s = 1e7;
  const Status status = run();
  ASSERT_FALSE(status);
  EXPECT_THAT(status.error().what, HasSubstr("every exposure saturates: 100 % of the pixels at 0.002 s"));
  EXPECT_THAT(status.error().where, HasSubstr("reference cell (1, 1)"));
  EXPECT_EQ(scanner.state(), failed);
}

TEST_F(ScannerTest, LampThatIsOffFails) {
  lamp_dn_per_s = 0;
  const Status status = run();
  ASSERT_FALSE(status);
  EXPECT_THAT(status.error().what, HasSubstr("no light above the dark set"));
  EXPECT_TRUE(sink.cells.empty());
}

TEST_F(ScannerTest, MovesOnceMoreWhenThePositionIsOff) {
  stage.off_by_mm = {0.03, 0};
  stage.off_from_move = 4, stage.off_until_move = 5;
  ASSERT_TRUE(run(all_but({0, 0})));
  EXPECT_EQ(stage.targets[3], stage.targets[4]);
  EXPECT_EQ(stage.moves, 5 + 1 + 1);
  EXPECT_EQ(camera.frames, 5 * 3);
  EXPECT_EQ(sink.cells[0].position_error_mm, 0);
}

TEST_F(ScannerTest, FailsWhenThePositionStaysOff) {
  stage.off_by_mm = {0.03, 0};
  stage.off_from_move = 4, stage.off_until_move = 6;
  const Status status = run(all_but({0, 0}));
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().where, "cell (0, 0), pass negative");
  EXPECT_THAT(status.error().what, HasSubstr("0.03 mm off after two moves; 0.02 mm are allowed"));
  EXPECT_FALSE(status.error().remedy.empty());
  EXPECT_EQ(camera.frames, 3 * 3);
  EXPECT_EQ(stage.halts, 1);
  EXPECT_EQ(scanner.state(), failed);
  EXPECT_EQ(stage.at, dark_target_mm(bench));
}

TEST_F(ScannerTest, TakesABracketAgainWhenTheStageMovedMeanwhile) {
  camera.on_expose = [&](int frame) {
    if (frame == 8) stage.at.x() += 0.05;
  };
  ASSERT_TRUE(run(all_but({0, 0})));
  EXPECT_EQ(camera.frames, 6 * 3);
  ASSERT_EQ(sink.cells.size(), 1U);
  EXPECT_EQ(sink.cells[0].passes[0].bracket[0].frame_id, 10U);  // 7 to 9 were discarded
}

TEST_F(ScannerTest, FailsWhenTheStageDoesNotHold) {
  camera.on_expose = [&](int frame) {
    if (frame > 6) stage.at.y() -= 0.015;
  };
  const Status status = run(all_but({0, 0}));
  ASSERT_FALSE(status);
  EXPECT_THAT(status.error().what, HasSubstr("moved by 0.045 mm during the exposures, twice"));
  EXPECT_EQ(camera.frames, 4 * 3);
  EXPECT_TRUE(sink.cells.empty());
}

TEST_F(ScannerTest, CameraFailureHaltsParksAndIsPassedOn) {
  camera.fail_at_frame = 11;
  const Status status = run();
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().what, "the camera is gone");
  EXPECT_EQ(status.error().where, "cell (0, 0), pass negative: camera");
  EXPECT_EQ(status.error().remedy, "check its cable");
  EXPECT_EQ(stage.halts, 1);
  EXPECT_EQ(stage.at, dark_target_mm(bench));
  EXPECT_EQ(scanner.state(), failed);
  EXPECT_EQ(sink.reports[sink.reports.size() - 2].state, parking);
}

TEST_F(ScannerTest, AlarmFailsAndSaysThatTheStageIsNotParked) {
  stage.alarm_at_move = 5;
  const Status status = run();
  ASSERT_FALSE(status);
  EXPECT_THAT(status.error().what, HasSubstr("alarm 1"));
  EXPECT_THAT(status.error().where, HasSubstr("cell (0, 1)"));
  EXPECT_THAT(status.error().remedy, HasSubstr("could not be parked"));
  EXPECT_EQ(stage.halts, 1);
  EXPECT_EQ(sink.cells.size(), 1U);
}

TEST_F(ScannerTest, SilentStageIsNotParked) {
  camera.on_expose = [&](int frame) { stage.silent = frame >= 5; };
  const Status status = run();
  ASSERT_FALSE(status);
  EXPECT_THAT(status.error().what, HasSubstr("no answer"));
  EXPECT_EQ(stage.moves, 2);
  EXPECT_EQ(scanner.state(), failed);
}

TEST_F(ScannerTest, HomingFailureMovesNothing) {
  stage.home_error = Error{"no switch found", "stage", "check the switches"};
  const Status status = run();
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().where, "homing: stage");
  EXPECT_EQ(stage.moves, 0);
  EXPECT_EQ(scanner.state(), failed);
}

TEST_F(ScannerTest, ParkingFailureAtTheEndFailsWithAllCellsDelivered) {
  stage.alarm_at_move = 2 + 12 + 1 + 1;
  const Status status = run();
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().where, "parking: stage");
  EXPECT_EQ(sink.cells.size(), 6U);
  EXPECT_EQ(stage.moves, 16);
}

TEST_F(ScannerTest, HomesOnlyWhenTheBenchSaysSo) {
  bench.stage.home = false;
  ASSERT_TRUE(run(all_but({0, 0})));
  EXPECT_EQ(stage.homings, 0);
  EXPECT_EQ(sink.reports[0].state, moving);
}

/// A stop request in any state ends in `stopped`: halted, without another move or frame.
class StopIn : public ScannerTest, public ::testing::WithParamInterface<ScanState> {};

TEST_P(StopIn, HaltsTheStageWhereItIs) {
  Vec2 at_stop(0, 0);
  int frames_at_stop = -1;
  sink.on_progress = [&](const ScanProgress& progress) {
    if (progress.state != GetParam() || frames_at_stop >= 0) return;
    stop.request_stop();
    at_stop = stage.at;
    frames_at_stop = camera.frames;
  };
  const Status status = run();
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().what, "stopped by the operator");
  EXPECT_EQ(scanner.state(), stopped);
  EXPECT_EQ(sink.reports.back().state, stopped);
  EXPECT_EQ(stage.halts, 1);
  EXPECT_EQ(stage.at, at_stop);
  EXPECT_EQ(camera.frames, frames_at_stop);
}
INSTANTIATE_TEST_SUITE_P(EveryState, StopIn, ::testing::Values(homing, moving, settling, exposing, delivering, parking),
                         [](const auto& tested) { return std::string(to_string(tested.param)); });

TEST_F(ScannerTest, StopWhileMovingReachesTheStage) {
  stage.on_move = [&](int move) {
    if (move == 4) stop.request_stop();
  };
  const Status status = run();
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().what, "stopped by the operator");
  EXPECT_EQ(stage.moves, 4);
  EXPECT_EQ(stage.halts, 1);
}

TEST_F(ScannerTest, StopCutsTheSettlingShort) {
  clock.on_wait = [&] { stop.request_stop(); };
  ASSERT_FALSE(run());
  EXPECT_EQ(camera.frames, 0);
  EXPECT_EQ(scanner.timing().settle_s, 0);
  EXPECT_EQ(scanner.state(), stopped);
}

TEST_F(ScannerTest, StopBetweenTwoExposuresEndsTheBracket) {
  camera.on_expose = [&](int frame) {
    if (frame == 8) stop.request_stop();
  };
  ASSERT_FALSE(run());
  EXPECT_EQ(camera.frames, 8);
  EXPECT_TRUE(sink.cells.empty());
  EXPECT_EQ(scanner.state(), stopped);
}

TEST_F(ScannerTest, AccountsForTheTime) {
  camera.readout_s = 0.03;  // 0.02 s are the bench's
  sink.busy_s = 0.25;
  plan.warm_up_s = 2;
  ASSERT_TRUE(run());
  const ScanTiming& timing = scanner.timing();
  const int positions = 1 + 1 + 12 + 1;
  EXPECT_NEAR(timing.settle_s, 2 + positions * 0.1, 1e-9);
  EXPECT_NEAR(timing.exposure_s, positions * 0.042, 1e-9);
  EXPECT_NEAR(timing.readout_s, positions * 3 * 0.02, 1e-9);
  EXPECT_NEAR(timing.other_s, positions * 3 * 0.01, 1e-9);
  EXPECT_NEAR(timing.waiting_s, 6 * 0.25, 1e-9);
  EXPECT_NEAR(timing.total_s, clock.now, 1e-9);
  const double parts = timing.move_s + timing.settle_s + timing.exposure_s + timing.readout_s;
  EXPECT_NEAR(timing.idle_share(), (timing.waiting_s + timing.other_s) / (parts + timing.waiting_s + timing.other_s),
              1e-9);
}

TEST_F(ScannerTest, PredictsTheTimeThatAnIdealBenchTakes) {
  camera.readout_s = bench.camera.readout_s;
  const auto steps = make_scan_plan(bench, plan);
  ASSERT_TRUE(steps);
  ASSERT_TRUE(scanner.run(*steps, sink, {}));
  // Reports start with homing, then the move to the first target, neither of which the prediction holds; so the time
  // left plus the time spent since then is the whole, at every report until parking.
  double first_move_end_s = -1;
  for (const ScanProgress& report : sink.reports) {
    if (report.state == settling && first_move_end_s < 0) first_move_end_s = report.elapsed_s;
    if (report.state == homing) {
      EXPECT_NEAR(report.left_s, steps->predicted_s, 1e-9);
    } else if (report.state == parking) {
      EXPECT_NEAR(report.elapsed_s - first_move_end_s, steps->predicted_s, 1e-9);
    }
  }
  EXPECT_GT(first_move_end_s, 0);
  EXPECT_EQ(sink.reports.back().left_s, 0);
  EXPECT_EQ(sink.reports.back().cells_done, 6);
  EXPECT_EQ(sink.reports.back().cells_total, 6);
}

TEST(SteadyBenchClock, WaitsAndIsCutShortByAStop) {
  EXPECT_TRUE(steady_bench_clock().wait(0.001, {}));
  std::stop_source stop;
  stop.request_stop();
  EXPECT_FALSE(steady_bench_clock().wait(3600, stop.get_token()));
  const double before = steady_bench_clock().now_s();
  EXPECT_GE(steady_bench_clock().now_s(), before);
}

}  // namespace
}  // namespace lumifield
