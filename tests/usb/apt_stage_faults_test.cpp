// What goes wrong with a stage on USB, and who else is there.
#include <algorithm>
#include <filesystem>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <linux/capability.h>
#include <map>
#include <sys/syscall.h>
#include <thread>
#include <unistd.h>

#include "tests/support/apt_double.h"

namespace lumifield {
namespace {

using testing::AllOf;
using testing::HasSubstr;

class AptStageFaults : public AptStageTest {};
INSTANTIATE_TEST_SUITE_P(Kinds, AptStageFaults, AptDouble::kinds(), AptDouble::name_of);

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

TEST_P(AptStageFaults, WithoutHomingItHasToBeHomed) {
  AptDouble controllers(options_);
  StageSettings settings = controllers.settings();
  settings.home = false;
  EXPECT_THAT(message(open_stage(settings)), HasSubstr("axis x is not homed"));
  { ASSERT_NE(controllers.open_homed(), nullptr); }
  const auto stage = controllers.open(settings);
  ASSERT_NE(stage, nullptr);
  EXPECT_TRUE(stage->move_to({1, 1}));
}

TEST_P(AptStageFaults, ALimitSwitchEndsTheMove) {
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

TEST_P(AptStageFaults, AMotionErrorHoldsUntilHomed) {
  AptDouble controllers = slow();
  const auto stage = controllers.open_homed();
  const auto other = on_the_way(controllers, [&] { controllers.server().trip_motion_error(); });
  EXPECT_THAT(message(stage->move_to({60, 40})), HasSubstr("axis x has a motion error"));
  EXPECT_THAT(message(stage->move_to({0, 0})), HasSubstr("motion error"));
  ASSERT_TRUE(stage->home());
  EXPECT_TRUE(stage->move_to({1, 1}));
}

TEST_P(AptStageFaults, SilenceIsNamed) {
  AptDouble controllers = slow();
  const auto stage = controllers.open_homed();
  const auto other = on_the_way(controllers, [&] { controllers.server().silence(true); });
  EXPECT_THAT(message(stage->move_to({60, 40})), HasSubstr("no answer within 2 s"));
  controllers.server().silence(false);
  EXPECT_TRUE(stage->move_to({1, 1})) << "usable again";
}

TEST_P(AptStageFaults, SilenceOnOpening) {
  AptDouble controllers(options_);
  controllers.server().silence(true);
  EXPECT_THAT(message(open_stage(controllers.settings())), HasSubstr("no answer within 2 s"));
}

TEST_P(AptStageFaults, AStageThatDoesNotStopIsToldBesideTheReason) {
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

TEST_P(AptStageFaults, AMoveHasADeadline) {
  AptDouble controllers(options_);
  const auto stage = controllers.open_homed();
  controllers.server().stick(true);
  EXPECT_THAT(message(stage->move_to({10, 0})), HasSubstr("did not arrive within 2."));
}

TEST_P(AptStageFaults, UnpluggedOnTheWayItIsGoneAndUsableWhenPluggedInAgain) {
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

TEST_P(AptStageFaults, StopsWhatAFormerOwnerLeftMoving) {
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

TEST_P(AptStageFaults, OneProgramAtATime) {
  AptDouble controllers(options_);
  const auto usable = find_stages();
  EXPECT_EQ(std::ranges::count_if(usable, [](const auto& r) { return r.usable && r.name.starts_with("Thorlabs "); }),
            GetParam() == Kind::pair ? 2 : 1);
  const DeviceReport named = probe_stage(controllers.settings());
  EXPECT_TRUE(named.usable) << named.reason;
  const std::map<Kind, std::string> names{{Kind::pair, "Thorlabs KDC101 27000001, Thorlabs KDC101 27000002"},
                                          {Kind::stepper_rack, "Thorlabs BSC202 70000001"},
                                          {Kind::servo_rack, "Thorlabs BBD302 103000001"}};
  EXPECT_EQ(named.name, names.at(GetParam()));
  const std::string controller = controllers.server().controller();
  EXPECT_EQ(named.capabilities, std::string("firmware 2.1.5; channels: ") + (GetParam() == Kind::pair ? "1" : "2") +
                                    "; controller " + controller);
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

TEST_P(AptStageFaults, OfAnotherKindThanTheBenchFileSaysIsRefused) {
  const AptDouble controllers(options_);
  StageSettings settings = controllers.settings();
  settings.apt.controller = GetParam() == Kind::stepper_rack ? "bbd30x" : "bsc20x";
  const std::string calls = ", which the bench file calls " + settings.apt.controller;
  const auto refused = open_stage(settings);
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().what, HasSubstr(calls));
  EXPECT_THAT(refused.error().remedy, HasSubstr("set stage.apt.controller to"));
  const DeviceReport report = probe_stage(settings);
  EXPECT_FALSE(report.usable);
  EXPECT_THAT(report.reason, HasSubstr(calls));
}

TEST_P(AptStageFaults, WithoutPermissionTheRuleThatGivesItIsNamed) {
  const AptDouble controllers(options_);
  namespace fs = std::filesystem;
  for (const auto& node : fs::directory_iterator(test::usb_bus().root() / "dev/bus/usb/001"))
    fs::permissions(node, fs::perms::none);
  const OrdinaryUser user;
  const auto refused = open_stage(controllers.settings());
  const auto seen = find_stages();
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().what, HasSubstr("no permission to open it"));
  EXPECT_THAT(refused.error().remedy, HasSubstr("scripts/setup --udev"));
  EXPECT_TRUE(std::ranges::any_of(seen, [](const auto& r) { return r.reason == "no permission to open it"; }));
}

TEST_P(AptStageFaults, AServosReadingShowsLostSteps) {
  AptDouble controllers(options_);
  const auto stage = controllers.open_homed();
  controllers.server().lose_steps(0.03);
  ASSERT_TRUE(stage->move_to({20, 10}));
  EXPECT_NEAR(controllers.server().true_position_mm().x(), 19.97, 1e-4);
  EXPECT_NEAR(stage->position().value().x(), GetParam() == Kind::stepper_rack ? 20 : 19.97, 1e-4);
  controllers.server().lose_steps(0.3);
  if (GetParam() == Kind::stepper_rack) return;
  EXPECT_THAT(message(stage->move_to({40, 10})), HasSubstr("axis x stands at 39.670 mm instead of 40.000 mm"));
}

}  // namespace
}  // namespace lumifield
