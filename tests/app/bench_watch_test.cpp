#include "app/session/bench_watch.h"

#include <chrono>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <thread>

#include "tests/support/double_bench.h"
#include "tests/support/small_bench.h"

namespace lumifield {
namespace {

using Link = DeviceView::Link;

class BenchWatchTest : public testing::Test {
 protected:
  std::unique_ptr<BenchWatch> watch(double exposure_s, std::unique_ptr<BenchWatch> before = nullptr) {
    return std::make_unique<BenchWatch>(test::small_bench(), exposure_s, view_, std::move(before), devices_.devices());
  }
  /// Whether the view comes to look so; only a test that fails waits long.
  template <class Wanted>
  bool comes(Wanted wanted) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(60);
    while (!wanted(view_->snapshot())) {
      if (std::chrono::steady_clock::now() > end) return false;
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    return true;
  }
  static bool exposed(const BenchSnapshot& now, double exposure_s) {
    return now.bracket && now.bracket->front().exposure_s == exposure_s;
  }

  test::DoubleBench devices_{8, 4};
  std::shared_ptr<BenchView> view_ = std::make_shared<BenchView>();
};

TEST_F(BenchWatchTest, ShowsWhatTheDevicesSeeAndLetsGoOfThem) {
  auto watching = watch(0.03);
  ASSERT_TRUE(comes([](const BenchSnapshot& now) { return exposed(now, 0.03); }));
  const BenchSnapshot now = view_->snapshot();
  EXPECT_EQ(now.camera.link, Link::open);
  EXPECT_EQ(now.stage.link, Link::open);
  EXPECT_FALSE(now.camera.name.empty());
  EXPECT_EQ(now.place, "live");
  EXPECT_EQ(now.bracket->size(), 1U);
  ASSERT_TRUE(now.stage_mm);
  EXPECT_EQ(devices_.open_now(), 2);
  watching->set_exposure(0.5);
  EXPECT_TRUE(comes([](const BenchSnapshot& later) { return exposed(later, 0.5); }));

  watching.reset();
  EXPECT_EQ(devices_.open_now(), 0);
  EXPECT_EQ(view_->snapshot().camera.link, Link::closed);
  EXPECT_EQ(view_->snapshot().stage.link, Link::closed);
  EXPECT_TRUE(view_->snapshot().bracket) << "the last picture stays";
}

TEST_F(BenchWatchTest, ADeviceThatFailsIsShownAndTriedAgain) {
  devices_.refuse_camera(true);
  const auto watching = watch(0.03);
  ASSERT_TRUE(comes([](const BenchSnapshot& now) { return now.camera.link == Link::failed; }));
  EXPECT_THAT(view_->snapshot().camera.error, testing::HasSubstr("does not answer"));
  ASSERT_TRUE(comes([](const BenchSnapshot& now) { return now.stage_mm.has_value(); })) << "the stage is shown";
  EXPECT_FALSE(view_->snapshot().bracket);
  devices_.refuse_camera(false);
  EXPECT_TRUE(comes([](const BenchSnapshot& now) { return now.camera.link == Link::open && now.bracket; }));
}

TEST_F(BenchWatchTest, ANewOneWaitsForTheDevicesOfTheOneBeforeInItsOwnThread) {
  auto first = watch(0.03);
  ASSERT_TRUE(comes([](const BenchSnapshot& now) { return exposed(now, 0.03); }));
  devices_.hold_exposures(true);
  auto second = watch(0.04, std::move(first));  // does not wait for the exposure
  devices_.hold_exposures(false);
  EXPECT_TRUE(comes([](const BenchSnapshot& now) { return exposed(now, 0.04); }));
  EXPECT_EQ(devices_.cameras_opened(), 2);
  EXPECT_EQ(devices_.most_cameras_at_once(), 1);
  EXPECT_EQ(devices_.most_stages_at_once(), 1);
}

TEST_F(BenchWatchTest, WithoutABenchItOnlyEndsTheOneBefore) {
  auto first = watch(0.03);
  ASSERT_TRUE(comes([](const BenchSnapshot& now) { return exposed(now, 0.03); }));
  const BenchWatch none(std::nullopt, 0, view_, std::move(first), devices_.devices());
  EXPECT_TRUE(comes([](const BenchSnapshot& now) { return now.camera.link == Link::closed; }));
  EXPECT_TRUE(comes([&](const BenchSnapshot&) { return devices_.open_now() == 0; }));
  EXPECT_EQ(devices_.cameras_opened(), 1);
}

}  // namespace
}  // namespace lumifield
