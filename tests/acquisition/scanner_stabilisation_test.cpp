#include <algorithm>
#include <cmath>
#include <gmock/gmock.h>

#include "tests/support/scanner_fixture.h"

namespace lumifield {
namespace {

using test::ScannerTest;
using ::testing::HasSubstr;

/// A lamp that is `excess` too bright when it is switched on, at 0 s; that fades with 60 s.
class ScannerStabilisation : public ScannerTest {
 protected:
  ScannerStabilisation() {
    plan.stabilisation = Stabilisation{0.01, 60, 1800};
    camera.signal_dn_per_s = [this](const Vec2& at) { return at.y() > 45 ? 0.0 : 2e4 * light(clock.now); };
    scanner.obey(control);
    sink.on_progress = [this](const ScanProgress& p) {
      if (p.cell && cells_begin_s < 0) cells_begin_s = clock.now;
      if (p.stabilisation && p.state == ScanState::stabilising) told.push_back(p);
    };
  }
  double light(double at_s) const { return 1 + excess * std::exp(-at_s / 60) + drift_per_s * at_s; }

  ScanControl control;
  double excess = 0.3, drift_per_s = 0;
  double cells_begin_s = -1;
  std::vector<ScanProgress> told;
};

TEST_F(ScannerStabilisation, NoCellIsTakenBeforeTheLampIsSteady) {
  ASSERT_TRUE(run());
  EXPECT_EQ(sink.cells.size(), 6U);
  // The world's own spread is within the limit now and was not 16 s ago; a DN is 0.16 %.
  const auto spread = [&](double at_s) { return light(at_s - 60) / light(at_s) - 1; };
  EXPECT_LT(spread(cells_begin_s), 0.01 + 0.0016);
  EXPECT_GT(spread(cells_begin_s - 16), 0.01 - 0.0016);
  EXPECT_GT(cells_begin_s, 200);

  ASSERT_EQ(sink.references.size(), 2U);
  const auto& end = sink.references[0].stabilised;
  ASSERT_TRUE(end);
  EXPECT_TRUE(end->steady);
  EXPECT_LE(end->spread, 0.01);
  EXPECT_NEAR(end->watched_s, cells_begin_s, 15);
  EXPECT_FALSE(sink.references[1].stabilised);
  EXPECT_LT(std::abs(sink.references[1].drift), 0.01);
}

TEST_F(ScannerStabilisation, TellsItsReadingsAndHowLongItMayTake) {
  ASSERT_TRUE(run());
  // Ten readings in 60 s.
  EXPECT_NEAR(static_cast<double>(told.size()), cells_begin_s / 6, 5);
  EXPECT_FALSE(told.front().stabilisation->spread);
  EXPECT_NEAR(told.front().stabilisation->signal_dn_per_s, 2e4 * light(told.front().elapsed_s), 50);
  EXPECT_NEAR(told.front().stabilisation->left_s - told.back().stabilisation->left_s,
              told.back().elapsed_s - told.front().elapsed_s, 1e-9);
  EXPECT_NEAR(told[1].left_s, told.back().left_s, 1e-9) << "the scan's own time does not run down";
  EXPECT_FALSE(sink.reports.back().stabilisation);
}

TEST_F(ScannerStabilisation, ALampThatIsNotSteadyInTimeEndsAScanThatNobodyAttends) {
  excess = 0;
  drift_per_s = 0.001;
  plan.stabilisation->limit_s = 300;
  const Status status = run();
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().kind, ErrorKind::waiting);
  EXPECT_THAT(status.error().message(), HasSubstr("reference cell (1, 1): the lamp is not steady after 30"));
  EXPECT_THAT(status.error().message(), HasSubstr("over 60 s, the plan allows 1 %"));
  EXPECT_TRUE(sink.cells.empty());
  EXPECT_TRUE(sink.references.empty());
  EXPECT_EQ(stage.at, dark_target_mm(bench));
}

TEST_F(ScannerStabilisation, AnAttendedScanPausesThenAndGoesOnWithTheLampAsItIs) {
  drift_per_s = 1e-4;
  excess = 0.5;
  plan.stabilisation = Stabilisation{0.001, 60, 120};
  plan.reference.limit = 1;
  control.attend();
  std::vector<std::string> troubles;
  sink.on_progress = [&](const ScanProgress& p) {
    if (p.state != ScanState::paused) return;
    troubles.push_back(p.trouble);
    EXPECT_FALSE(p.stabilisation);
    clock.now += 1000;
    control.resume();
  };
  ASSERT_TRUE(run());
  ASSERT_EQ(troubles.size(), 1U);
  EXPECT_THAT(troubles[0], HasSubstr("the lamp is not steady after 12"));
  ASSERT_TRUE(sink.references[0].stabilised);
  EXPECT_FALSE(sink.references[0].stabilised->steady);
  EXPECT_GT(sink.references[0].stabilised->spread, 0.001);
  EXPECT_EQ(sink.cells.size(), 6U);
}

TEST_F(ScannerStabilisation, WhereDriftIsAcceptedItGoesOnByItself) {
  excess = 0;
  drift_per_s = 0.001;
  plan.stabilisation->limit_s = 300;
  plan.reference.limit = 1;
  scanner.accept_drift();
  ASSERT_TRUE(run());
  EXPECT_EQ(sink.cells.size(), 6U);
  ASSERT_EQ(sink.notices.size(), 1U);
  EXPECT_THAT(sink.notices[0], HasSubstr("the scan goes on"));
  EXPECT_FALSE(sink.references[0].stabilised->steady);
}

TEST_F(ScannerStabilisation, IsStoppedWhileItWaits) {
  clock.on_wait = [&] {
    if (told.size() == 5) stop.request_stop();
  };
  const Status status = run();
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().kind, ErrorKind::stopped);
  EXPECT_EQ(told.size(), 5U);
  EXPECT_EQ(sink.reports.back().state, ScanState::stopped);
}

TEST_F(ScannerStabilisation, AfterAPauseTheWatchBeginsAnew) {
  excess = 0;
  bool paused = false;
  sink.on_progress = [&](const ScanProgress& p) {
    if (p.stabilisation && p.elapsed_s > 50 && !std::exchange(paused, true)) control.pause();
    if (p.state != ScanState::paused) return;
    clock.now += 500;
    control.resume();
  };
  ASSERT_TRUE(run());
  EXPECT_TRUE(paused);
  EXPECT_NEAR(sink.references[0].stabilised->watched_s, 60, 7);
}

TEST_F(ScannerStabilisation, ALampThatIsOffIsTold) {
  camera.signal_dn_per_s = [](const Vec2&) { return 0.0; };
  const Status status = run();
  ASSERT_FALSE(status);
  EXPECT_THAT(status.error().message(), HasSubstr("no light above the dark set"));
}

}  // namespace
}  // namespace lumifield
