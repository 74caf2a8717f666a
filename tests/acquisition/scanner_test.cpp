#include "acquisition/scan/scanner.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <set>

#include "tests/support/scanner_fixture.h"

namespace lumifield {
namespace {

using enum ScanState;
using test::ScannerTest;
using ::testing::HasSubstr;

TEST(ScanStates, FollowTheDrawing) {
  const std::set<std::pair<ScanState, ScanState>> arrows{{idle, homing},
                                                         {idle, moving},
                                                         {idle, done},
                                                         {homing, moving},
                                                         {moving, settling},
                                                         {settling, moving},
                                                         {settling, exposing},
                                                         {exposing, moving},
                                                         {exposing, delivering},
                                                         {delivering, moving},
                                                         {delivering, parking},
                                                         {parking, done},
                                                         {moving, parking},
                                                         {settling, parking},
                                                         {exposing, parking},
                                                         {idle, paused},
                                                         {homing, paused},
                                                         {moving, paused},
                                                         {settling, paused},
                                                         {exposing, paused},
                                                         {delivering, paused},
                                                         {paused, paused},
                                                         {paused, homing},
                                                         {paused, moving},
                                                         {paused, parking},
                                                         {paused, reconnecting},
                                                         {exposing, reconnecting},
                                                         {reconnecting, moving},
                                                         {reconnecting, paused},
                                                         {reconnecting, parking},
                                                         {moving, moving},
                                                         {moving, delivering},
                                                         {moving, homing},
                                                         {exposing, stabilising},
                                                         {stabilising, moving},
                                                         {stabilising, paused},
                                                         {stabilising, parking},
                                                         {reconnecting, reconnecting}};
  const std::vector<ScanState> all{idle,         homing, moving,  settling, exposing, stabilising, delivering,
                                   reconnecting, paused, parking, done,     stopped,  failed};
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
  plan.reference.limit = 1;
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

TEST_F(ScannerTest, HomesOnlyWhenTheBenchSaysSo) {
  bench.stage.home = false;
  ASSERT_TRUE(run(all_but({0, 0})));
  EXPECT_EQ(stage.homings, 0);
  EXPECT_EQ(sink.reports[0].state, moving);
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

TEST_F(ScannerTest, ProgressCountsTheCellsThatWereThereBefore) {
  ASSERT_TRUE(run({{0, 1}, {1, 2}}));
  EXPECT_EQ(sink.reports.front().cells_done, 2);
  EXPECT_EQ(sink.reports.back().cells_done, 6);
  for (const ScanProgress& report : sink.reports) {
    EXPECT_EQ(report.cells_total, 6);
    EXPECT_EQ(report.cells_before, 2);
  }
}

TEST_F(ScannerTest, ARehearsalExposesAtNoCorner) {
  const auto steps = make_rehearsal(bench, plan, {0, 2});
  ASSERT_TRUE(steps) << steps.error().message();
  ASSERT_TRUE(scanner.run(*steps, sink, stop.get_token()));
  EXPECT_EQ(camera.frames, (1 + 1 + 2) * 3);  // dark set, reference, the shot's passes
  EXPECT_EQ(stage.moves, 1 + 8 + 1 + 2 + 1);
  ASSERT_EQ(sink.cells.size(), 1U);
  EXPECT_EQ(sink.cells[0].cell, (CellIndex{0, 2}));
  EXPECT_EQ(stage.at, dark_target_mm(bench));
  EXPECT_EQ(scanner.state(), done);
}

TEST_F(ScannerTest, ARehearsalTellsACornerThatIsNotReached) {
  stage.off_by_mm = {0.03, 0};
  stage.off_from_move = 3, stage.off_until_move = 99;
  const auto steps = make_rehearsal(bench, plan, {0, 2});
  const Status status = scanner.run(*steps, sink, stop.get_token());
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().where, "corner cell (0, 2), pass positive");
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
