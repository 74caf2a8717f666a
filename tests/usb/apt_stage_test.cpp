#include "acquisition/stages/apt_stage.h"

#include <atomic>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <map>
#include <thread>

#include "tests/support/apt_double.h"

namespace lumifield {
namespace {

using std::chrono::milliseconds;
using testing::AllOf;
using testing::HasSubstr;

INSTANTIATE_TEST_SUITE_P(Kinds, AptStageTest, AptDouble::kinds(), AptDouble::name_of);

TEST_P(AptStageTest, ReportsWhatTheControllersSay) {
  const AptDouble controllers(options_);
  const auto stage = controllers.open();
  ASSERT_NE(stage, nullptr);
  const std::map<Kind, std::pair<std::string, std::string>> told{
      {Kind::pair, {"KDC101 2.1.5, KDC101 2.1.5", "27000001, 27000002"}},
      {Kind::stepper_rack, {"BSC202 2.1.5", "70000001"}},
      {Kind::servo_rack, {"BBD302 2.1.5", "103000001"}}};
  EXPECT_EQ(stage->info().firmware, told.at(GetParam()).first);
  EXPECT_EQ(stage->info().path, told.at(GetParam()).second);
  EXPECT_NEAR(stage->info().rapid_mm_s, 200, 0.01);
  EXPECT_NEAR(stage->info().acceleration_mm_s2, 2000, 0.5);
  EXPECT_EQ(stage->info().travel_mm, Vec2(200, 150));
}

TEST_P(AptStageTest, HomesMovesAndReadsBack) {
  AptDouble controllers(options_);
  const auto stage = controllers.open_homed();
  ASSERT_NE(stage, nullptr);
  EXPECT_EQ(controllers.server().true_position_mm(), Vec2(0, 0));
  for (const Vec2& target : {Vec2(7.5, 3.25), Vec2(7.5, 3.25), Vec2(0.001, 0), Vec2(20, 10)}) {
    const Status moved = stage->move_to(target);
    ASSERT_TRUE(moved) << moved.error().message();
    const Result<Vec2> q = stage->position();
    ASSERT_TRUE(q) << q.error().message();
    EXPECT_LT((*q - target).cwiseAbs().maxCoeff(), a_count(controllers));
    EXPECT_LT((controllers.server().true_position_mm() - *q).norm(), 1e-9);
  }
  EXPECT_LT((controllers.prepared().back() - controllers.server().true_position_mm()).norm(), 1e-9);
}

TEST_P(AptStageTest, BothAxesMoveAtOnce) {
  AptDouble controllers = slow();
  const auto stage = controllers.open_homed();
  std::atomic<bool> both = false;
  {
    std::jthread watch([&](std::stop_token stop) {
      while (!stop.stop_requested() && !both) {
        const Vec2 at = controllers.server().true_position_mm();
        both = at.x() > 0 && at.x() < 10 && at.y() > 0 && at.y() < 8;
        std::this_thread::sleep_for(milliseconds(1));
      }
    });
    const Status moved = stage->move_to({10, 8});
    ASSERT_TRUE(moved) << moved.error().message();
  }
  EXPECT_TRUE(both);
}

TEST_P(AptStageTest, AMoveEndsWhereItWasSentThoughNothingTellsIt) {
  options_.tells_completion = false;
  AptDouble controllers(options_);
  const auto stage = controllers.open_homed();
  const Status moved = stage->move_to({20, 10});
  ASSERT_TRUE(moved) << moved.error().message();
  EXPECT_LT((controllers.server().true_position_mm() - Vec2(20, 10)).norm(), a_count(controllers));
}

TEST_P(AptStageTest, HaltFromAnotherThreadEndsHoming) {
  options_.homing_mm_s = 5;
  options_.power_up_mm = {100, 100};
  AptDouble controllers(options_);
  const auto stage = controllers.open();
  std::jthread other([&] {
    while (controllers.server().true_position_mm().x() > 99.5) std::this_thread::sleep_for(milliseconds(1));
    stage->halt();
  });
  EXPECT_THAT(message(stage->home()), HasSubstr("stopped homing before it was homed"));
}

TEST_P(AptStageTest, ADirectionTurnsTheReadings) {
  AptDouble controllers(options_);
  StageSettings settings = controllers.settings();
  settings.apt.direction = {-1, 1};
  const auto stage = controllers.open(settings);
  ASSERT_TRUE(stage->home());
  const Status moved = stage->move_to({-7.5, 4});
  ASSERT_TRUE(moved) << moved.error().message();
  EXPECT_LT((controllers.server().true_position_mm() - Vec2(7.5, 4)).norm(), a_count(controllers));
  EXPECT_LT((stage->position().value() - Vec2(-7.5, 4)).norm(), a_count(controllers));
  EXPECT_THAT(message(stage->move_to({7.5, 4})), HasSubstr("beyond the travel, (-200, 0) to (0, 150) mm"));
}

TEST_P(AptStageTest, SpeedsAreSetAndReadBack) {
  options_.most_mm_s = 60;
  options_.rapid_mm_s = 20;
  AptDouble controllers(options_);
  StageSettings settings = controllers.settings();
  settings.rapid_mm_s = 50;
  settings.acceleration_mm_s2 = 300;
  {
    const auto stage = controllers.open(settings);
    ASSERT_NE(stage, nullptr);
    EXPECT_NEAR(stage->info().rapid_mm_s, 50, 0.01);
    EXPECT_NEAR(stage->info().acceleration_mm_s2, 300, 0.5);
  }
  settings.rapid_mm_s = 61;
  EXPECT_THAT(message(open_stage(settings)), HasSubstr("axis x took 50 mm/s and 300 mm/s² instead of 61 and 300"));
}

TEST_P(AptStageTest, StopRequestKeepsThePosition) {
  AptDouble controllers = slow();
  const auto stage = controllers.open_homed();
  std::stop_source stop;
  const auto other = on_the_way(controllers, [&] { stop.request_stop(); });
  const Status moved = stage->move_to({60, 0}, stop.get_token());
  ASSERT_FALSE(moved);
  EXPECT_EQ(moved.error().what, "stopped by the operator");
  EXPECT_EQ(moved.error().kind, ErrorKind::stopped);
  const Result<Vec2> q = stage->position();
  ASSERT_TRUE(q) << q.error().message();
  EXPECT_GT(q->x(), 2);
  EXPECT_LT(q->x(), 59);
  EXPECT_LT((controllers.server().true_position_mm() - *q).norm(), a_count(controllers)) << "it stands";
  EXPECT_TRUE(stage->move_to({0, 0})) << "usable again without homing";
}

TEST_P(AptStageTest, HaltFromAnotherThreadEndsTheMove) {
  AptDouble controllers = slow();
  const auto stage = controllers.open_homed();
  const auto other = on_the_way(controllers, [&] { stage->halt(); });
  EXPECT_THAT(message(stage->move_to({60, 0})),
              AllOf(HasSubstr("axis x stands at"), HasSubstr("instead of 60.000 mm")));
  EXPECT_TRUE(stage->position());
  const Status moved = stage->move_to({0, 0});
  EXPECT_TRUE(moved) << moved.error().message();
}

TEST_P(AptStageTest, StopRequestEndsHoming) {
  options_.homing_mm_s = 5;
  options_.power_up_mm = {100, 100};
  AptDouble controllers(options_);
  const auto stage = controllers.open();
  std::stop_source stop;
  std::jthread other([&] {
    while (controllers.server().true_position_mm().x() > 99.5) std::this_thread::sleep_for(milliseconds(1));
    stop.request_stop();
  });
  const Status homed = stage->home(stop.get_token());
  ASSERT_FALSE(homed);
  EXPECT_EQ(homed.error().what, "stopped by the operator");
  EXPECT_THAT(message(stage->move_to({1, 1})), HasSubstr("axis x is not homed; its position is unknown"));
}

TEST_P(AptStageTest, NothingMovesAfterAStopRequest) {
  AptDouble controllers(options_);
  const auto stage = controllers.open_homed();
  std::stop_source stop;
  stop.request_stop();
  EXPECT_FALSE(stage->move_to({5, 5}, stop.get_token()));
  EXPECT_FALSE(stage->home(stop.get_token()));
  EXPECT_EQ(controllers.server().true_position_mm(), Vec2(0, 0));
}

TEST_P(AptStageTest, RefusesTargetsBeyondTheTravel) {
  AptDouble controllers(options_);
  const auto stage = controllers.open_homed();
  for (const Vec2& target : {Vec2(201, 0), Vec2(0, -0.1), Vec2(NAN, 0), Vec2(0, 1e300)})
    EXPECT_THAT(message(stage->move_to(target)), HasSubstr("beyond the travel"));
  EXPECT_EQ(controllers.server().true_position_mm(), Vec2(0, 0));
}

TEST_P(AptStageTest, StatusIsToldForAsLongAsItIsAsked) {
  AptDouble controllers(options_);
  const auto stage = controllers.open_homed();
  for (int i = 0; i < 120; ++i) ASSERT_TRUE(stage->position()) << i;
}

TEST_P(AptStageTest, CannotLookForItsHomeSwitches) {
  AptDouble controllers(options_);
  StageSettings settings = controllers.settings();
  settings.check_home = true;
  EXPECT_THAT(message(open_stage(settings)), HasSubstr("cannot look for its home switches"));
  const auto stage = controllers.open();
  EXPECT_FALSE(stage->slipped_mm());
}

}  // namespace
}  // namespace lumifield
