#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/scanner_fixture.h"

namespace lumifield {
namespace {

using testing::DoubleEq;
using testing::ElementsAre;
using testing::HasSubstr;

std::vector<double> exposures_of(const Bracket& bracket) {
  std::vector<double> all;
  for (const RawImage& frame : bracket) all.push_back(frame.exposure_s);
  return all;
}

/// The plan's 0.002, 0.008, 0.032 s, down to 0.000125 and up to 2.048 s; 4095 DN saturate, black is at 64. One cell is
/// taken, (1, 1) is the reference cell. Signals of the two passes in DN/s.
class ScannerExposuresTest : public test::ScannerTest {
 protected:
  ScannerExposuresTest() {
    bench.sensor.black_level_dn = 64;
    plan.exposure_limits_s = {0.0001, 3};
    camera.signal_dn_per_s = [this](const Vec2& at) {
      if (at.y() > 45) return 0.0;
      if (sink.references.empty() || sink.cells.size() == 1) return 20'000.0;
      return at.x() > 45 ? negative_dn_per_s : positive_dn_per_s;
    };
  }
  std::vector<double> taken(std::size_t pass) const { return exposures_of(sink.cells.at(0).passes.at(pass).bracket); }

  double positive_dn_per_s = 20'000, negative_dn_per_s = 20'000;
};

TEST_F(ScannerExposuresTest, WithoutLimitsEveryPassHasThePlans) {
  plan.exposure_limits_s.reset();
  positive_dn_per_s = 1e9, negative_dn_per_s = 1;
  ASSERT_TRUE(run(all_but({0, 0})));
  EXPECT_EQ(taken(0), plan.exposures_s);
  EXPECT_EQ(taken(1), plan.exposures_s);
  EXPECT_EQ(exposures_of(sink.cells[0].dark->bracket), plan.exposures_s);
}

TEST_F(ScannerExposuresTest, TakesThePlansWhereTheyFit) {
  positive_dn_per_s = 100'000;  // 3200 DN at 0.032 s
  negative_dn_per_s = 0;
  ASSERT_TRUE(run(all_but({0, 0})));
  EXPECT_EQ(taken(0), plan.exposures_s);
  EXPECT_EQ(taken(1), plan.exposures_s);
}

TEST_F(ScannerExposuresTest, ASaturatedPassGoesShorterAndTheOtherStays) {
  positive_dn_per_s = 3e6;  // 6000 DN at 0.002 s, 1500 at 0.0005 s
  negative_dn_per_s = 100'000;
  ASSERT_TRUE(run(all_but({0, 0})));
  EXPECT_THAT(taken(0), ElementsAre(DoubleEq(0.0005), 0.002, 0.008, 0.032));
  EXPECT_EQ(taken(1), plan.exposures_s);
  for (const RawPass& pass : sink.cells[0].passes)
    for (const RawImage& frame : pass.bracket) EXPECT_EQ(frame.stage_mm, pass.stage_mm);
}

TEST_F(ScannerExposuresTest, AStarvedPassGoesLongerUntilTheNextWouldSaturate) {
  negative_dn_per_s = 5'000;  // 640 DN at 0.128 s, 2560 at 0.512 s, 10240 at 2.048 s
  positive_dn_per_s = 100'000;
  ASSERT_TRUE(run(all_but({0, 0})));
  EXPECT_EQ(taken(0), plan.exposures_s);
  EXPECT_THAT(taken(1), ElementsAre(0.002, 0.008, 0.032, DoubleEq(0.128), DoubleEq(0.512)));
}

TEST_F(ScannerExposuresTest, ADarkCellIsNotExposedLonger) {
  positive_dn_per_s = negative_dn_per_s = 0;
  ASSERT_TRUE(run(all_but({0, 0})));
  EXPECT_EQ(taken(0), plan.exposures_s);
  EXPECT_EQ(taken(1), plan.exposures_s);
}

TEST_F(ScannerExposuresTest, TheLimitsEndBothWays) {
  positive_dn_per_s = 1e9;
  negative_dn_per_s = 100;  // 205 DN at 2.048 s
  ASSERT_TRUE(run(all_but({0, 0})));
  EXPECT_THAT(taken(0), ElementsAre(DoubleEq(0.000125), DoubleEq(0.0005), 0.002, 0.008, 0.032));
  EXPECT_THAT(taken(1), ElementsAre(0.002, 0.008, 0.032, DoubleEq(0.128), DoubleEq(0.512), DoubleEq(2.048)));
}

TEST_F(ScannerExposuresTest, DarkSetsHaveAllAndTheReferenceCellThePlans) {
  int exposed = 0;
  sink.on_progress = [&](const ScanProgress& progress) {
    if (progress.state == ScanState::delivering && progress.place == "dark set 1") exposed = camera.frames;
    if (progress.state == ScanState::delivering && progress.place == "reference cell (1, 1)" && sink.cells.empty()) {
      EXPECT_EQ(camera.frames - exposed, 3);
    }
  };
  ASSERT_TRUE(run(all_but({0, 0})));
  EXPECT_EQ(exposed, 8);
  EXPECT_THAT(exposures_of(sink.cells[0].dark->bracket),
              ElementsAre(DoubleEq(0.000125), DoubleEq(0.0005), 0.002, 0.008, 0.032, DoubleEq(0.128), DoubleEq(0.512),
                          DoubleEq(2.048)));
  ASSERT_EQ(sink.references.size(), 2U);
  for (const ReferenceReading& reading : sink.references) {
    EXPECT_EQ(reading.exposure_s, 0.032);
    EXPECT_NEAR(reading.signal_dn_per_s, 20'000, 1e-6);
  }
}

TEST_F(ScannerExposuresTest, TheWholeBracketIsTakenAgainWhenTheStageMoved) {
  positive_dn_per_s = negative_dn_per_s = 3e6;
  bool moved = false;
  camera.on_expose = [&](int frame) {
    if (frame != 8 + 3 + 4 || moved) return;  // the first cell's added one
    moved = true;
    stage.at += Vec2(0.5, 0);
  };
  ASSERT_TRUE(run(all_but({0, 0})));
  EXPECT_TRUE(moved);
  EXPECT_THAT(taken(0), ElementsAre(DoubleEq(0.0005), 0.002, 0.008, 0.032));
  EXPECT_EQ(camera.frames, 8 + 3 + 3 * 4 + 3);
}

TEST_F(ScannerExposuresTest, ACameraThatFailsAtAnAddedExposureFailsTheCell) {
  positive_dn_per_s = negative_dn_per_s = 3e6;
  camera.fail_at_frame = 8 + 3 + 4;
  const Status status = run(all_but({0, 0}));
  ASSERT_FALSE(status);
  EXPECT_THAT(status.error().message(), HasSubstr("cell (0, 0), pass positive"));
  EXPECT_TRUE(sink.cells.empty());
}

TEST_F(ScannerExposuresTest, AStopIsObeyedBetweenAddedExposures) {
  positive_dn_per_s = negative_dn_per_s = 1e9;
  camera.on_expose = [&](int frame) {
    if (frame == 8 + 3 + 4) stop.request_stop();
  };
  const Status status = run(all_but({0, 0}));
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().kind, ErrorKind::stopped);
  EXPECT_EQ(camera.frames, 8 + 3 + 4);
}

}  // namespace
}  // namespace lumifield
