#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "acquisition/scan/scanner.h"
#include "tests/support/scanner_fixture.h"

namespace lumifield {
namespace {

using enum ScanState;
using test::ScannerTest;
using ::testing::HasSubstr;

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
  EXPECT_EQ(status.error().remedy, "home it (the stage could not be parked)") << "the cause is told once";
  EXPECT_EQ(stage.halts, 1);
  EXPECT_EQ(sink.cells.size(), 1U);
}

TEST_F(ScannerTest, AStageThatCannotBeParkedAfterAnotherDeviceFailedIsTold) {
  camera.fail_at_frame = 8;
  camera.on_expose = [&](int frame) { stage.alarm = frame == 8; };
  const Status status = run();
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().what, "the camera is gone");
  EXPECT_EQ(status.error().remedy,
            "check its cable (the stage could not be parked: alarm 1: a limit switch was hit; home it)");
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
  EXPECT_EQ(status.error().kind, ErrorKind::stopped);
  EXPECT_EQ(scanner.state(), stopped);
  EXPECT_EQ(sink.reports.back().state, stopped);
  EXPECT_EQ(stage.halts, 1);
  EXPECT_EQ(stage.at, at_stop);
  EXPECT_EQ(camera.frames, frames_at_stop);
}
INSTANTIATE_TEST_SUITE_P(EveryState, StopIn, ::testing::Values(homing, moving, settling, exposing, delivering, parking),
                         [](const auto& tested) { return std::string(to_string(tested.param)); });

TEST_F(ScannerTest, AbandonedItParksAndFails) {
  std::stop_source abandon;
  camera.on_expose = [&](int frame) {
    if (frame == 8) abandon.request_stop();
  };
  const auto steps = make_scan_plan(bench, plan);
  ASSERT_TRUE(steps);
  const Status status = scanner.run(*steps, sink, stop.get_token(), abandon.get_token());
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().kind, ErrorKind::stopped) << "the fault is not the scan's";
  EXPECT_EQ(scanner.state(), failed);
  EXPECT_EQ(camera.frames, 8);
  EXPECT_EQ(stage.at, dark_target_mm(bench));
}

TEST_F(ScannerTest, AbandonedWithAStageThatCannotBeParkedItTellsThat) {
  std::stop_source abandon;
  camera.on_expose = [&](int frame) {
    if (frame != 8) return;
    abandon.request_stop();
    stage.alarm = true;
  };
  const auto steps = make_scan_plan(bench, plan);
  ASSERT_TRUE(steps);
  const Status status = scanner.run(*steps, sink, stop.get_token(), abandon.get_token());
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().kind, ErrorKind::fault);
  EXPECT_EQ(status.error().message(), "parking: stage: alarm 1: a limit switch was hit; home it");
}

TEST_F(ScannerTest, DriftRefersToTheEarlierScan) {
  plan.reference.limit = 1;
  scanner.refer_to({0, 40'000, 0, 0.008});
  ASSERT_TRUE(run());
  ASSERT_FALSE(sink.references.empty());
  EXPECT_NEAR(sink.references.front().drift, -0.5, 1e-3);
  EXPECT_EQ(sink.references.front().exposure_s, 0.008);
  EXPECT_NEAR(sink.cells.front().drift, -0.5, 1e-3);
}

TEST_F(ScannerTest, AnEarlierScanWithAnotherExposureIsRefused) {
  scanner.refer_to({0, 40'000, 0, 0.009});
  EXPECT_THAT(run().error().what, HasSubstr("no exposure of 0.009 s"));
}

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

TEST_F(ScannerTest, ADeviceThatFailsWhileTheScanIsStoppedIsTold) {
  camera.fail_at_frame = 8;
  camera.on_expose = [&](int frame) {
    if (frame == 8) stop.request_stop();
  };
  const Status status = run();
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().what, "the camera is gone");
  EXPECT_EQ(status.error().kind, ErrorKind::fault);
  EXPECT_THAT(status.error().remedy, HasSubstr("not parked"));
  EXPECT_EQ(scanner.state(), failed);
  EXPECT_EQ(stage.halts, 1);
  EXPECT_NE(stage.at, dark_target_mm(bench));
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

}  // namespace
}  // namespace lumifield
