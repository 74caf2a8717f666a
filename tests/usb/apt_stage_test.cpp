#include "acquisition/stages/apt_stage.h"

#include <algorithm>
#include <atomic>
#include <filesystem>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <linux/capability.h>
#include <sys/syscall.h>
#include <thread>
#include <unistd.h>

#include "tests/support/apt_double.h"

namespace lumifield {
namespace {

using std::chrono::milliseconds;
using testing::AllOf;
using testing::HasSubstr;
using Kind = AptDouble::Kind;

/// While it lives, the file permissions are true for this thread, whoever it runs as.
class OrdinaryUser {
 public:
  OrdinaryUser() {
    EXPECT_EQ(syscall(SYS_capget, &header_, before_), 0);
    __user_cap_data_struct less[2] = {before_[0], before_[1]};
    less[0].effective &= ~(1U << CAP_DAC_OVERRIDE | 1U << CAP_DAC_READ_SEARCH);
    EXPECT_EQ(syscall(SYS_capset, &header_, less), 0);
  }
  ~OrdinaryUser() { EXPECT_EQ(syscall(SYS_capset, &header_, before_), 0); }

 private:
  __user_cap_header_struct header_{_LINUX_CAPABILITY_VERSION_3, 0};
  __user_cap_data_struct before_[2] = {};
};

template <class T>
std::string message(const Result<T>& result) {
  return result ? "no error" : result.error().message();
}

class AptStageTest : public testing::TestWithParam<Kind> {
 protected:
  void SetUp() override {
    if (!AptDouble::can_run()) GTEST_SKIP() << AptDouble::why_not;
    options_.kind = GetParam();
    options_.power_up_mm = {3, 2};
  }
  /// One whose moves take long enough to be met on the way.
  AptDouble slow() {
    options_.rapid_mm_s = 20;
    options_.acceleration_mm_s2 = 400;
    return AptDouble(options_);
  }
  /// Acts on another thread once the carriage has passed 2 mm in x.
  template <class F>
  static std::jthread on_the_way(AptDouble& controllers, F act) {
    return std::jthread([&controllers, act](std::stop_token stop) {
      while (!(controllers.server().true_position_mm().x() > 2) && !stop.stop_requested())
        std::this_thread::sleep_for(milliseconds(1));
      act();
    });
  }
  /// How far a reading may be off, mm.
  static double a_count(AptDouble& controllers) { return 0.8 / controllers.server().counts_per_mm(); }

  virtual_bench::AptOptions options_;
};
INSTANTIATE_TEST_SUITE_P(Kinds, AptStageTest, testing::Values(Kind::pair, Kind::rack),
                         [](const auto& each) { return each.param == Kind::pair ? "pair" : "rack"; });

TEST_P(AptStageTest, ReportsWhatTheControllersSay) {
  const AptDouble controllers(options_);
  const auto stage = controllers.open();
  ASSERT_NE(stage, nullptr);
  const bool is_pair = GetParam() == Kind::pair;
  EXPECT_EQ(stage->info().firmware, is_pair ? "KDC101 2.1.5, KDC101 2.1.5" : "BSC202 2.1.5");
  EXPECT_EQ(stage->info().path, is_pair ? "27000001, 27000002" : "70000001");
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
  EXPECT_THAT(message(stage->home()), HasSubstr("axis x stopped homing before it was homed"));
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

TEST_P(AptStageTest, WithoutHomingItHasToBeHomed) {
  AptDouble controllers(options_);
  StageSettings settings = controllers.settings();
  settings.home = false;
  EXPECT_THAT(message(open_stage(settings)), HasSubstr("axis x is not homed"));
  { ASSERT_NE(controllers.open_homed(), nullptr); }
  const auto stage = controllers.open(settings);
  ASSERT_NE(stage, nullptr);
  EXPECT_TRUE(stage->move_to({1, 1}));
}

TEST_P(AptStageTest, ALimitSwitchEndsTheMove) {
  AptDouble controllers = slow();
  const auto stage = controllers.open_homed();
  const auto other = on_the_way(controllers, [&] { controllers.server().trip_limit(); });
  const Status moved = stage->move_to({60, 40});
  EXPECT_THAT(message(moved), HasSubstr("axis x was stopped by a limit switch at"));
  const double y = controllers.server().true_position_mm().y();
  EXPECT_LT(y, 39) << "the other axis is stopped, too";
  EXPECT_THAT(message(stage->move_to({0, 0})), HasSubstr("limit switch"));
  ASSERT_TRUE(stage->home());
  EXPECT_TRUE(stage->move_to({1, 1}));
}

TEST_P(AptStageTest, AMotionErrorHoldsUntilHomed) {
  AptDouble controllers = slow();
  const auto stage = controllers.open_homed();
  const auto other = on_the_way(controllers, [&] { controllers.server().trip_motion_error(); });
  EXPECT_THAT(message(stage->move_to({60, 40})), HasSubstr("axis x has a motion error"));
  EXPECT_THAT(message(stage->move_to({0, 0})), HasSubstr("motion error"));
  ASSERT_TRUE(stage->home());
  EXPECT_TRUE(stage->move_to({1, 1}));
}

TEST_P(AptStageTest, SilenceIsNamed) {
  AptDouble controllers = slow();
  const auto stage = controllers.open_homed();
  const auto other = on_the_way(controllers, [&] { controllers.server().silence(true); });
  EXPECT_THAT(message(stage->move_to({60, 40})), HasSubstr("no answer within 2 s"));
  controllers.server().silence(false);
  EXPECT_TRUE(stage->move_to({1, 1})) << "usable again";
}

TEST_P(AptStageTest, SilenceOnOpening) {
  AptDouble controllers(options_);
  controllers.server().silence(true);
  EXPECT_THAT(message(open_stage(controllers.settings())), HasSubstr("no answer within 2 s"));
}

TEST_P(AptStageTest, AStageThatDoesNotStopIsToldBesideTheReason) {
  AptDouble controllers = slow();
  const auto stage = controllers.open_homed();
  std::stop_source stop;
  const auto other = on_the_way(controllers, [&] {
    controllers.server().stick(true);
    stop.request_stop();
  });
  EXPECT_THAT(
      message(stage->move_to({60, 0}, stop.get_token())),
      AllOf(HasSubstr("stopped by the operator; and then: it does not stop"), HasSubstr("switch the stage off")));
}

TEST_P(AptStageTest, AMoveHasADeadline) {
  AptDouble controllers(options_);
  const auto stage = controllers.open_homed();
  controllers.server().stick(true);
  EXPECT_THAT(message(stage->move_to({10, 0})), HasSubstr("did not arrive within 2."));
}

TEST_P(AptStageTest, UnpluggedOnTheWayItIsGoneAndUsableWhenPluggedInAgain) {
  AptDouble controllers = slow();
  auto stage = controllers.open_homed();
  {
    const auto other = on_the_way(controllers, [&] { EXPECT_TRUE(controllers.server().unplug(true)); });
    const Status moved = stage->move_to({60, 40});
    ASSERT_FALSE(moved);
    EXPECT_THAT(moved.error().what, HasSubstr("the stage is gone"));
    EXPECT_THAT(moved.error().remedy, HasSubstr("plug it in"));
  }
  stage->halt();
  EXPECT_THAT(message(stage->position()), HasSubstr("the stage is gone"));
  stage.reset();
  EXPECT_THAT(message(open_stage(controllers.settings())), HasSubstr("no USB device with this serial number"));
  ASSERT_TRUE(controllers.server().unplug(false));

  // It has its own power: it knows where it is, and may still be moving.
  StageSettings settings = controllers.settings();
  settings.home = false;
  stage = controllers.open(settings);
  ASSERT_NE(stage, nullptr);
  EXPECT_LT((stage->position().value() - controllers.server().true_position_mm()).norm(), a_count(controllers));
  const Status moved = stage->move_to({5, 5});
  EXPECT_TRUE(moved) << moved.error().message();
}

TEST_P(AptStageTest, StopsWhatAFormerOwnerLeftMoving) {
  AptDouble controllers = slow();
  auto stage = controllers.open_homed();
  const auto other = on_the_way(controllers, [&] { EXPECT_TRUE(controllers.server().unplug(true)); });
  EXPECT_FALSE(stage->move_to({100, 0}));
  stage.reset();
  ASSERT_TRUE(controllers.server().unplug(false));
  stage = controllers.open();
  const Vec2 at = controllers.server().true_position_mm();
  EXPECT_LT(at.x(), 100);
  EXPECT_LT((stage->position().value() - at).norm(), a_count(controllers));
}

TEST_P(AptStageTest, OneProgramAtATime) {
  const AptDouble controllers(options_);
  const auto usable = find_stages();
  EXPECT_EQ(std::ranges::count_if(usable, [](const auto& r) { return r.usable && r.name.starts_with("Thorlabs "); }),
            GetParam() == Kind::pair ? 2 : 1);
  const DeviceReport named = probe_stage(controllers.settings());
  EXPECT_TRUE(named.usable) << named.reason;
  EXPECT_EQ(named.name, GetParam() == Kind::pair ? "Thorlabs KDC101 27000001, Thorlabs KDC101 27000002"
                                                 : "Thorlabs BSC202 70000001");
  const auto owner = controllers.open();
  ASSERT_NE(owner, nullptr);
  EXPECT_THAT(message(open_stage(controllers.settings())), HasSubstr("in use by another program"));
  const auto busy = find_stages();
  const auto at = std::ranges::find(busy, controllers.settings().apt.serials[0], &DeviceReport::address);
  ASSERT_NE(at, busy.end());
  EXPECT_FALSE(at->usable);
  EXPECT_THAT(at->reason, HasSubstr("in use by another program"));
  EXPECT_FALSE(at->name.empty());
  EXPECT_TRUE(owner->position()) << "not disturbed";
}

TEST_P(AptStageTest, WithoutPermissionTheRuleThatGivesItIsNamed) {
  const AptDouble controllers(options_);
  namespace fs = std::filesystem;
  for (const auto& node : fs::directory_iterator(AptDouble::bus().root() / "dev/bus/usb/001"))
    fs::permissions(node, fs::perms::none);
  const OrdinaryUser user;
  const auto refused = open_stage(controllers.settings());
  const auto seen = find_stages();
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().what, HasSubstr("no permission to open it"));
  EXPECT_THAT(refused.error().remedy, AllOf(HasSubstr("ATTR{idProduct}==\"faf0\""), HasSubstr("/etc/udev/rules.d")));
  EXPECT_TRUE(std::ranges::any_of(seen, [](const auto& r) { return r.reason == "no permission to open it"; }));
}

TEST_P(AptStageTest, StatusIsToldForAsLongAsItIsAsked) {
  AptDouble controllers(options_);
  const auto stage = controllers.open_homed();
  for (int i = 0; i < 120; ++i) ASSERT_TRUE(stage->position()) << i;
}

TEST_P(AptStageTest, AServosReadingShowsLostSteps) {
  AptDouble controllers(options_);
  const auto stage = controllers.open_homed();
  controllers.server().lose_steps(0.03);
  ASSERT_TRUE(stage->move_to({20, 10}));
  EXPECT_NEAR(controllers.server().true_position_mm().x(), 19.97, 1e-4);
  EXPECT_NEAR(stage->position().value().x(), GetParam() == Kind::pair ? 19.97 : 20, 1e-4);
  controllers.server().lose_steps(0.3);
  if (GetParam() == Kind::rack) return;
  EXPECT_THAT(message(stage->move_to({40, 10})), HasSubstr("axis x stands at 39.670 mm instead of 40.000 mm"));
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
