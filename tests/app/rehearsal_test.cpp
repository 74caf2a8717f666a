#include "app/session/rehearsal.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/double_bench.h"
#include "tests/support/small_bench.h"

namespace lumifield {
namespace {

using testing::HasSubstr;
constexpr int width = 160, height = 120;

RehearsalRequest request(test::DoubleBench& doubles) {
  RehearsalRequest made;
  made.bench = test::developed_bench();
  made.plan = test::developed_plan();
  made.out = testing::TempDir() + "/not/there/yet.lumi";
  made.devices = doubles.devices();
  return made;
}

TEST(Rehearsal, TellsTheShotsQualityAndWhatTheScanTakes) {
  test::DoubleBench doubles(width, height);
  RehearsalRequest made = request(doubles);
  made.shot = CellIndex{0, 2};
  std::vector<std::string> places;
  const auto told = rehearse(made, {}, [&](const ScanProgress& p) { places.push_back(p.place); });
  ASSERT_TRUE(told) << told.error().message();
  EXPECT_EQ(told->places, 8);
  EXPECT_EQ(told->shot, (CellIndex{0, 2}));
  EXPECT_EQ(told->quality.saturated_share, 0);
  // 64 DN and 50,000 DN/s for 0.032 s
  EXPECT_NEAR(told->brightest_share, (64 + 1600) / 4000.0, 1e-3);
  EXPECT_NEAR(told->signal_dn_per_s, 5e4, 50);
  EXPECT_EQ(told->scan.cells, 6);
  EXPECT_EQ(told->scan.bytes, 6 * 24 * 18 * 8);
  EXPECT_GT(told->scan.time_s, 12 * 0.102);
  EXPECT_EQ(told->scan.stabilisation_s, 0);
  ASSERT_TRUE(told->scan.free_bytes);
  EXPECT_GT(*told->scan.free_bytes, 0);
  EXPECT_THAT(places, testing::Contains("corner cell (1, 0), pass negative"));
  EXPECT_EQ(doubles.open_now(), 0);
}

TEST(Rehearsal, DoesNotWaitForASteadyLampButTellsThatTheScanWill) {
  test::DoubleBench doubles(width, height);
  RehearsalRequest made = request(doubles);
  made.plan.stabilisation = Stabilisation{0.01, 3600, 7200};
  const auto told = rehearse(made, {}, [](const ScanProgress& p) { EXPECT_FALSE(p.stabilisation); });
  ASSERT_TRUE(told) << told.error().message();
  EXPECT_EQ(told->scan.stabilisation_s, 7200);
}

TEST(Rehearsal, TakesThePassWhoseSlideIsIn) {
  test::DoubleBench doubles(width, height);
  RehearsalRequest made = request(doubles);
  made.bench.filter.change = PassChange::by_operator;
  const auto told = rehearse(made, {}, [](const ScanProgress&) {});
  ASSERT_TRUE(told) << told.error().message();
  EXPECT_NEAR(told->brightest_share, (64 + 1600) / 4000.0, 1e-3);
  EXPECT_EQ(told->scan.cells, 6);
  // Half cells wait on the disk, three exposures each.
  EXPECT_EQ(told->scan.bytes, 6 * 24 * 18 * 8 + (6 + 1) * 3 * width * height * 2);
}

TEST(Rehearsal, TellsADeviceThatFails) {
  test::DoubleBench doubles(width, height);
  doubles.trip_stage_after(3);
  const auto told = rehearse(request(doubles), {}, [](const ScanProgress&) {});
  ASSERT_FALSE(told);
  EXPECT_THAT(told.error().message(), HasSubstr("corner cell (1, 2), pass positive: stage: alarm 1"));
  EXPECT_EQ(doubles.open_now(), 0);
}

TEST(Rehearsal, IsStopped) {
  test::DoubleBench doubles(width, height);
  std::stop_source stop;
  const auto told = rehearse(request(doubles), stop.get_token(), [&](const ScanProgress& p) {
    if (p.place.starts_with("corner")) stop.request_stop();
  });
  ASSERT_FALSE(told);
  EXPECT_EQ(told.error().kind, ErrorKind::stopped);
}

}  // namespace
}  // namespace lumifield
