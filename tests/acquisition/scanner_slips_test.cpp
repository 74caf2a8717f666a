#include <algorithm>
#include <gmock/gmock.h>
#include <map>

#include "tests/support/scanner_fixture.h"

namespace lumifield {
namespace {

using test::ScannerTest;
using ::testing::HasSubstr;

/// Blocks of two cells: dark, reference, A, B, dark, C, D, dark, E, F, reference. The home switches are looked for
/// after the first reference, before the second and the third dark set, and at the end.
class ScannerSlips : public ScannerTest {
 protected:
  ScannerSlips() {
    bench.stage.check_home = true;
    plan.dark_every_cells = 2;
    scanner.obey(control);
    camera.on_expose = [this](int) { exposed_off = exposed_off || !stage.slip_mm.isZero(0); };
  }
  /// The stage loses steps in the move after which so many cells are taken.
  void slip_after(std::size_t cells, const Vec2& by_mm = {0.05, 0}) {
    stage.on_move = [this, cells, by_mm, slipped = false](int) mutable {
      if (sink.cells.size() == cells && !std::exchange(slipped, true)) stage.slip_mm = by_mm;
    };
  }
  std::map<CellIndex, int> times_taken() const {
    std::map<CellIndex, int> times;
    for (const RawCell& cell : sink.cells) ++times[cell.cell];
    return times;
  }

  ScanControl control;
  bool exposed_off = false;
};

TEST_F(ScannerSlips, AreLookedForBeforeEveryDarkSetButTheFirstAndAtTheEnd) {
  ASSERT_TRUE(run());
  EXPECT_EQ(stage.looks, 4);
  EXPECT_EQ(stage.homings, 1);
  EXPECT_EQ(sink.cells.size(), 6U);
  EXPECT_GT(scanner.timing().move_s, 4 * stage.look_s);
  EXPECT_NEAR(scanner.timing().other_s, 0, 1e-9);
}

TEST_F(ScannerSlips, AreNotLookedForUnlessTheBenchSaysSo) {
  bench.stage.check_home = false;
  slip_after(1);
  ASSERT_TRUE(run());
  EXPECT_EQ(stage.looks, 0);
  EXPECT_EQ(sink.cells.size(), 6U);
}

TEST_F(ScannerSlips, AreHomedAwayAndTheBlockIsTakenAgain) {
  slip_after(3);
  ASSERT_TRUE(run());
  EXPECT_TRUE(exposed_off);
  EXPECT_EQ(stage.homings, 2);
  const auto times = times_taken();
  for (const auto& [cell, taken] : times) {
    const bool in_that_block = cell == CellIndex{0, 2} || cell == CellIndex{1, 2};
    EXPECT_EQ(taken, in_that_block ? 2 : 1);
  }
  EXPECT_EQ(times.size(), 6U);
  EXPECT_EQ(sink.reports.back().cells_done, 6);
  EXPECT_EQ(std::ranges::count(sink.places_seen, "dark set 2"), 2);
  ASSERT_EQ(sink.notices.size(), 1U);
  EXPECT_THAT(sink.notices[0], HasSubstr("home switches: the stage has slipped by (0.05, 0) mm since it was homed"));
}

TEST_F(ScannerSlips, OfTheLastBlockAreFoundAtTheEnd) {
  slip_after(5);
  ASSERT_TRUE(run());
  EXPECT_EQ(sink.cells.size(), 8U);
  EXPECT_EQ(stage.homings, 2);
  EXPECT_EQ(stage.at, dark_target_mm(bench));
}

TEST_F(ScannerSlips, WithinTheToleranceAreLeft) {
  slip_after(3, {0.012, 0.012});
  ASSERT_TRUE(run());
  EXPECT_EQ(sink.cells.size(), 6U);
  EXPECT_EQ(stage.homings, 1);
}

TEST_F(ScannerSlips, AFirstReadingIsHandedOnOnlyFromTheRightPlace) {
  slip_after(0);
  sink.on_progress = [&](const ScanProgress&) {
    EXPECT_TRUE(sink.references.empty() || !sink.cells.empty() || stage.slip_mm.isZero(0));
  };
  ASSERT_TRUE(run());
  EXPECT_EQ(stage.homings, 2);
  EXPECT_EQ(sink.references.size(), 2U);
  EXPECT_EQ(sink.references[0].cells_done, 0);
  EXPECT_EQ(sink.cells.size(), 6U);
}

TEST_F(ScannerSlips, ThatComeBackEachTimeEndAScanThatNobodyAttends) {
  stage.on_move = [this](int) {
    if (sink.cells.size() >= 2) stage.slip_mm = {0, 0.3};
  };
  const Status status = run();
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().where, "home switches");
  EXPECT_THAT(status.error().what, HasSubstr("slipped by (0, 0.3) mm"));
  EXPECT_EQ(stage.homings, 1 + 3);
  EXPECT_EQ(scanner.state(), ScanState::failed);
  EXPECT_EQ(stage.at, dark_target_mm(bench));
  ASSERT_EQ(sink.notices.size(), 4U);
  EXPECT_THAT(sink.notices[3], HasSubstr("last looked for before cell (0, 2): from there to cell (1, 2)"));
}

TEST_F(ScannerSlips, PauseAnAttendedScanAndAreHomedOnTheOperatorsWord) {
  control.attend();
  std::vector<std::string> troubles;
  sink.on_progress = [&](const ScanProgress& p) {
    if (p.state != ScanState::paused) return;
    EXPECT_EQ(stage.homings, 1);
    troubles.push_back(p.trouble);
    control.resume();
  };
  slip_after(3);
  ASSERT_TRUE(run());
  ASSERT_EQ(troubles.size(), 1U);
  EXPECT_THAT(troubles[0], HasSubstr("slipped by (0.05, 0) mm"));
  EXPECT_EQ(stage.homings, 2);
  EXPECT_EQ(sink.cells.size(), 8U);
}

TEST_F(ScannerSlips, HiddenByHomingAfterAnAlarmAreSupposed) {
  control.attend();
  sink.on_progress = [&](const ScanProgress& p) {
    if (p.state != ScanState::paused) return;
    stage.alarm = false;
    control.resume();
  };
  class Recovery final : public DeviceRecovery {
   public:
    Recovery(Camera& its_camera, Stage& its_stage) : camera_(its_camera), stage_(its_stage) {}
    Camera& camera() override { return camera_; }
    Stage& stage() override { return stage_; }
    Status reopen_camera() override { return {}; }
    Status reopen_stage() override { return {}; }

   private:
    Camera& camera_;
    Stage& stage_;
  } recovery(camera, stage);
  scanner.recover_with(recovery);
  stage.on_move = [&](int move) {
    if (sink.cells.size() == 3 && stage.alarm_at_move == 0) stage.alarm_at_move = move + 1;
  };
  ASSERT_TRUE(run());
  EXPECT_EQ(sink.cells.size(), 7U) << "the cell before the alarm once more";
  EXPECT_EQ(times_taken().size(), 6U);
  EXPECT_EQ(sink.reports.back().cells_done, 6);
}

TEST_F(ScannerSlips, CellsTakenOnTheOperatorsWordAreTakenAgainToo) {
  slip_after(3);
  sink.on_progress = [&, asked = false](const ScanProgress& p) mutable {
    if (p.cells_done == 3 && !std::exchange(asked, true)) control.retake(std::vector<CellIndex>{{0, 0}});
  };
  ASSERT_TRUE(run());
  EXPECT_EQ((times_taken()[{0, 0}]), 3) << "by plan, on the operator's word, and as it may have stood wrong";
  EXPECT_EQ(sink.cells.size(), 6U + 2 + 2);
  EXPECT_EQ(sink.reports.back().cells_done, 6);
}

TEST_F(ScannerSlips, AreNotTakenForDrift) {
  plan.reference.every = 2;
  slip_after(2, {1, 0});
  camera.signal_dn_per_s = [this](const Vec2& at) {
    return at.y() > 45 ? 0.0 : stage.slip_mm.isZero(0) ? 20'000 : 19'000;
  };
  ASSERT_TRUE(run());
  EXPECT_EQ(sink.cells.size(), 6U);
  EXPECT_EQ(stage.homings, 2);
}

}  // namespace
}  // namespace lumifield
