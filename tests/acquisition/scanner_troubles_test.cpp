#include <algorithm>
#include <gmock/gmock.h>

#include "tests/support/scanner_fixture.h"

namespace lumifield {
namespace {

using test::ScannerTest;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

/// Opens the doubles again when asked to, after so many refusals.
class RecoveryDouble final : public DeviceRecovery {
 public:
  RecoveryDouble(test::CameraDouble& its_camera, test::StageDouble& its_stage)
      : camera_(its_camera), stage_(its_stage) {}
  Camera& camera() override { return camera_; }
  Stage& stage() override { return stage_; }
  Status reopen_camera() override {
    ++cameras_opened;
    return refuse(camera_refusals, "no camera there");
  }
  Status reopen_stage() override {
    ++stages_opened;
    stage_.alarm = stage_.silent = false;
    return refuse(stage_refusals, "no stage there");
  }

  int camera_refusals = 0, stage_refusals = 0;
  int cameras_opened = 0, stages_opened = 0;

 private:
  static Status refuse(int& times, const char* why) {
    if (times > 0) return --times, fail(why, "bench", "plug it in");
    return {};
  }
  test::CameraDouble& camera_;
  test::StageDouble& stage_;
};

class ScannerTroubles : public ScannerTest {
 protected:
  ScannerTroubles() {
    scanner.obey(control);
    scanner.recover_with(recovery);
  }
  /// Somebody is there, and says "go on" to each of the first so many troubles, then "stop".
  void attend(int patience) {
    control.attend();
    sink.on_progress = [this, patience](const ScanProgress& p) mutable {
      if (p.state != ScanState::paused) return;
      troubles.push_back(p.trouble);
      patience-- > 0 ? control.resume() : (void)stop.request_stop();
    };
  }
  std::ptrdiff_t times_in(ScanState state) const { return std::ranges::count(sink.states(), state); }
  std::vector<CellIndex> cells_taken() const {
    std::vector<CellIndex> cells;
    for (const RawCell& cell : sink.cells) cells.push_back(cell.cell);
    return cells;
  }

  RecoveryDouble recovery{camera, stage};
  ScanControl control;
  std::vector<std::string> troubles;
};

TEST_F(ScannerTroubles, ACameraThatIsGoneWhileTheLampIsWatchedIsOpenedAndTheWatchBeginsAnew) {
  plan.stabilisation = Stabilisation{0.01, 60, 90};
  camera.fail_at_frame = 3 + 3 * 8;  // the eighth reading
  ASSERT_TRUE(run());
  EXPECT_EQ(recovery.cameras_opened, 1);
  EXPECT_EQ(sink.cells.size(), 6U);
  EXPECT_NEAR(sink.references[0].stabilised->watched_s, 60, 7);
}

TEST_F(ScannerTroubles, ACameraThatWasGoneIsOpenedAndTheCellTakenAgain) {
  camera.fail_at_frame = 11;  // second pass of the first cell
  recovery.camera_refusals = 3;
  ASSERT_TRUE(run());
  EXPECT_EQ(sink.cells.size(), 6U);
  EXPECT_EQ(recovery.cameras_opened, 4);
  EXPECT_EQ(scanner.cameras_lost(), 1);
  EXPECT_EQ(times_in(ScanState::reconnecting), 4);
  EXPECT_EQ(camera.frames, 3 + 3 + (3 + 2) + 6 * 6 + 3);  // dark, reference, what was lost, all cells, reference
  EXPECT_NEAR(scanner.timing().lost_s, 0.6, 1e-9);
  EXPECT_THAT(sink.notices,
              ElementsAre("cell (0, 0), pass negative: camera: the camera is gone; it is waited for up to 60 s: check "
                          "its cable",
                          HasSubstr("the camera is gone; it is back after 0.6 s and cell (0, 0) is taken again")));
  EXPECT_EQ(sink.cells[0].passes[0].bracket.size(), 3U);
}

TEST_F(ScannerTroubles, WhileACameraIsWaitedForTheTimeGoesOnAndWhatIsLeftDoesNotRunDown) {
  camera.fail_at_frame = 11;
  recovery.camera_refusals = 50;
  std::vector<ScanProgress> waiting;
  sink.on_progress = [&](const ScanProgress& p) {
    if (p.state == ScanState::reconnecting) waiting.push_back(p);
    EXPECT_EQ(sink.notices.empty(), waiting.empty()) << "it is said before the first look for it";
  };
  ASSERT_TRUE(run());
  ASSERT_EQ(waiting.size(), 51U);
  EXPECT_NEAR(waiting.back().elapsed_s - waiting.front().elapsed_s, 10, 1e-9);
  EXPECT_NEAR(waiting.back().left_s, waiting.front().left_s, 1e-9);
}

TEST_F(ScannerTroubles, ACameraThatStaysAwayEndsAScanThatNobodyAttends) {
  camera.fail_at_frame = 11;
  recovery.camera_refusals = 1 << 20;
  const Status status = run();
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().message(), "cell (0, 0): bench: did not come back within 60 s: no camera there; plug it in");
  EXPECT_EQ(scanner.state(), ScanState::failed);
  EXPECT_EQ(stage.at, dark_target_mm(bench));
}

TEST_F(ScannerTroubles, ACameraThatFailsAtOnceEachTimeIsNotOpenedForEver) {
  camera.on_expose = [&](int frame) { camera.fail_at_frame = frame > 6 ? frame : 0; };
  ASSERT_FALSE(run());
  EXPECT_EQ(recovery.cameras_opened, 5);
}

TEST_F(ScannerTroubles, ACameraThatRefusesIsNotTakenForALostOne) {
  camera.refuse_from_frame = 11;
  const Status status = run();
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().message(),
            "cell (0, 0), pass negative: camera: an exposure of 0.008 s is out of its range; choose another");
  EXPECT_EQ(status.error().kind, ErrorKind::refused);
  EXPECT_EQ(recovery.cameras_opened, 0);
  EXPECT_EQ(camera.frames, 11);
  EXPECT_EQ(scanner.cameras_lost(), 0);
  EXPECT_TRUE(sink.notices.empty());
  EXPECT_EQ(scanner.state(), ScanState::failed);
}

TEST_F(ScannerTroubles, WhatACameraRefusesIsAskedForAgainOnTheOperatorsWordOnly) {
  attend(2);
  camera.refuse_from_frame = 11;
  camera.on_expose = [&](int) {
    if (troubles.size() == 2) camera.refuse_from_frame = 0;
  };
  ASSERT_TRUE(run());
  ASSERT_EQ(troubles.size(), 2U);
  EXPECT_THAT(troubles[1], HasSubstr("out of its range"));
  EXPECT_EQ(recovery.cameras_opened, 0);
  EXPECT_TRUE(sink.notices.empty());
  EXPECT_EQ(sink.cells.size(), 6U);
}

TEST_F(ScannerTroubles, ACameraThatStaysAwayPausesAndIsTriedAgainOnTheOperatorsWord) {
  attend(1);
  camera.fail_at_frame = 11;
  recovery.camera_refusals = 301;  // every 0.2 s, for a minute
  ASSERT_TRUE(run());
  ASSERT_EQ(troubles.size(), 1U);
  EXPECT_THAT(troubles[0], HasSubstr("did not come back"));
  EXPECT_EQ(sink.cells.size(), 6U);
  EXPECT_EQ(sink.references.size(), 3U);  // one after the pause
}

TEST_F(ScannerTroubles, AnAlarmPausesHaltedAndIsHomedAwayOnTheOperatorsWord) {
  attend(1);
  stage.alarm_at_move = 5;
  ASSERT_TRUE(run());
  ASSERT_EQ(troubles.size(), 1U);
  EXPECT_THAT(troubles[0], HasSubstr("alarm 1: a limit switch was hit; home it"));
  EXPECT_EQ(recovery.stages_opened, 1);
  EXPECT_EQ(stage.homings, 2);
  EXPECT_GE(stage.halts, 1);
  EXPECT_EQ(sink.cells.size(), 6U);
  EXPECT_EQ(sink.references.size(), 3U);
  EXPECT_EQ(sink.reports.back().trouble, "");
}

TEST_F(ScannerTroubles, WithoutAnOperatorAnAlarmEndsTheScan) {
  stage.alarm_at_move = 5;
  const Status status = run();
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().kind, ErrorKind::fault);
  EXPECT_EQ(times_in(ScanState::paused), 0);
}

TEST_F(ScannerTroubles, AStageThatDoesNotComeBackPausesAgain) {
  attend(3);
  stage.alarm_at_move = 5;
  recovery.stage_refusals = 2;
  ASSERT_TRUE(run());
  ASSERT_EQ(troubles.size(), 3U);
  EXPECT_THAT(troubles[2], HasSubstr("no stage there"));
  EXPECT_EQ(recovery.stages_opened, 3);
  EXPECT_EQ(sink.cells.size(), 6U);
}

TEST_F(ScannerTroubles, HomingThatFailsPausesBeforeAnythingMoves) {
  attend(1);
  stage.home_error = Error{"no switch within 200 mm", "stage", "check the switches"};
  const auto go_on = sink.on_progress;
  sink.on_progress = [&, go_on](const ScanProgress& p) {
    if (p.state == ScanState::paused) stage.home_error.reset();
    go_on(p);
  };
  ASSERT_TRUE(run());
  EXPECT_EQ(troubles.size(), 1U);
  EXPECT_EQ(stage.homings, 2) << "the one that failed, and one";
  EXPECT_EQ(sink.cells.size(), 6U);
}

TEST_F(ScannerTroubles, AStageThatStandsWrongPausesAndNothingIsExposedThere) {
  attend(1);
  stage.off_by_mm = {0.03, 0};
  stage.off_from_move = 4, stage.off_until_move = 6;
  camera.on_expose = [&](int) {
    EXPECT_TRUE(std::ranges::any_of(stage.targets, [&](const Vec2& t) { return (t - stage.at).norm() <= 0.02; }));
  };
  ASSERT_TRUE(run());
  ASSERT_EQ(troubles.size(), 1U);
  EXPECT_THAT(troubles[0], HasSubstr("0.03 mm off after two moves"));
  EXPECT_EQ(recovery.stages_opened, 1);
}

TEST_F(ScannerTroubles, TheOperatorMayEndInATrouble) {
  attend(0);
  stage.alarm_at_move = 5;
  const Status status = run();
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().kind, ErrorKind::stopped);
  EXPECT_EQ(scanner.state(), ScanState::stopped);
  EXPECT_EQ(recovery.stages_opened, 0);
}

TEST_F(ScannerTroubles, ACellThatIsTakenAgainSurvivesATrouble) {
  attend(1);
  const auto go_on = sink.on_progress;
  sink.on_progress = [&, go_on, asked = false](const ScanProgress& p) mutable {
    if (p.cells_done == 2 && !std::exchange(asked, true)) {
      control.retake(std::vector<CellIndex>{{0, 0}});
      stage.alarm_at_move = stage.moves + 4;  // two passes of the cell at hand, then the retake's second
    }
    go_on(p);
  };
  ASSERT_TRUE(run());
  EXPECT_EQ(troubles.size(), 1U);
  EXPECT_EQ(sink.cells.size(), 7U);
  EXPECT_EQ(std::ranges::count(cells_taken(), CellIndex{0, 0}), 2);
}

class ScannerDrift : public ScannerTroubles {
 protected:
  ScannerDrift() {
    plan.reference.every = 2;
    camera.signal_dn_per_s = [this](const Vec2& at) {
      const double drift = sink.cells.size() >= 4 ? late : sink.cells.size() >= 2 ? early : 0;
      return at.y() > 45 ? 0.0 : 20'000 * (1 + drift);
    };
  }
  double early = 0, late = 0;  ///< from the third cell on, from the fifth on
};

TEST_F(ScannerDrift, BeyondThePlansLimitWaitsForTheOperator) {
  early = late = 0.05;
  const Status status = run();
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().kind, ErrorKind::waiting);
  EXPECT_EQ(status.error().where, "reference cell (1, 1)");
  EXPECT_THAT(status.error().what, HasSubstr("has drifted by 5 %, the plan allows 1 %"));
  EXPECT_EQ(sink.cells.size(), 2U);
  EXPECT_EQ(sink.references.size(), 2U);  // the reading that tells it is on record
  EXPECT_EQ(stage.at, dark_target_mm(bench));
}

TEST_F(ScannerDrift, WithinItNothingPauses) {
  attend(0);
  early = 0.009, late = -0.009;
  ASSERT_TRUE(run());
  EXPECT_TRUE(troubles.empty());
}

TEST_F(ScannerDrift, ThatTheOperatorHasSeenPausesOnce) {
  attend(9);
  early = late = 0.05;
  ASSERT_TRUE(run());
  EXPECT_EQ(troubles.size(), 1U);
  EXPECT_EQ(recovery.stages_opened, 0);
  EXPECT_EQ(sink.cells.size(), 6U);
  EXPECT_NEAR(sink.cells[5].drift, 0.05, 1e-9);
}

TEST_F(ScannerDrift, FurtherThanSeenPausesAgain) {
  attend(9);
  early = 0.05, late = -0.01;
  ASSERT_TRUE(run());
  EXPECT_EQ(troubles.size(), 2U);
}

TEST_F(ScannerDrift, OfAnEarlierScanIsATroubleUnlessItIsKnown) {
  scanner.refer_to({0, 40'000, 0, 0.032});
  const Status status = run();
  ASSERT_FALSE(status);
  EXPECT_THAT(status.error().what, HasSubstr("has drifted by -50 %"));
  EXPECT_TRUE(sink.cells.empty());
}

TEST_F(ScannerDrift, OfAnEarlierScanThatIsKnownIsRecorded) {
  scanner.refer_to({0, 40'000, 0, 0.032});
  scanner.accept_drift();
  ASSERT_TRUE(run());
  EXPECT_NEAR(sink.cells[0].drift, -0.5, 1e-9);
}

}  // namespace
}  // namespace lumifield
