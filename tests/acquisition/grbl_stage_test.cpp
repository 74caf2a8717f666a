#include "acquisition/stages/grbl_stage.h"

#include <algorithm>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <thread>

#include "acquisition/links/serial_link.h"
#include "tests/support/scripted_grbl.h"

namespace lumifield {
namespace {

using testing::HasSubstr;
using Fault = ScriptedGrbl::Fault;
using Script = ScriptedGrbl::Script;
using std::chrono::milliseconds;

StageSettings settings_for(const std::string& path) {
  StageSettings settings;
  settings.path = path;
  return settings;
}

std::unique_ptr<Stage> open(const ScriptedGrbl& grbl) {
  auto stage = open_stage(settings_for(grbl.path()));
  EXPECT_TRUE(stage) << stage.error().message();
  return stage ? std::move(*stage) : nullptr;
}

std::unique_ptr<Stage> open_homed(const ScriptedGrbl& grbl) {
  auto stage = open(grbl);
  if (!stage) return nullptr;
  const Status homed = stage->home();
  EXPECT_TRUE(homed) << homed.error().message();
  return stage;
}

template <class T>
std::string message(const Result<T>& result) {
  return result ? "no error" : result.error().message();
}

TEST(GrblStage, ReportsWhatTheControllerSays) {
  const ScriptedGrbl grbl;
  const auto stage = open(grbl);
  EXPECT_EQ(stage->info().firmware, "Grbl 1.1h.20190825");
  EXPECT_EQ(stage->info().path, grbl.path());
  EXPECT_DOUBLE_EQ(stage->info().rapid_mm_s, 5000. / 60);
  EXPECT_DOUBLE_EQ(stage->info().acceleration_mm_s2, 400);
  EXPECT_EQ(stage->info().travel_mm, Vec2(200, 150));
}

TEST(GrblStage, HomesMovesAndReadsBack) {
  const ScriptedGrbl grbl;
  const auto stage = open_homed(grbl);
  for (const Vec2& target : {Vec2(7.5, 3.25), Vec2(7.5, 3.25), Vec2(0.0004, 0), Vec2(20, 10)}) {
    const Status moved = stage->move_to(target);
    ASSERT_TRUE(moved) << moved.error().message();
    const Result<Vec2> q = stage->position();
    ASSERT_TRUE(q) << q.error().message();
    EXPECT_LT((*q - target).norm(), 1e-3);
    EXPECT_LT((grbl.position() - target).norm(), 1e-3);
  }
}

TEST(GrblStage, ReturnsOnlyWhenStandingStill) {
  const ScriptedGrbl grbl;
  const auto stage = open_homed(grbl);
  ASSERT_TRUE(stage->move_to({15, 0}));
  EXPECT_EQ(grbl.state(), "Idle");
}

TEST(GrblStage, PositionsAreMachinePositionsWhateverIsReported) {
  Script script;
  script.reports_work = script.reports_inches = true;
  script.work_offset_mm = {12.7, -25.4};
  const ScriptedGrbl grbl(script);
  const auto stage = open_homed(grbl);
  const Status moved = stage->move_to({5, 8});
  ASSERT_TRUE(moved) << moved.error().message();
  EXPECT_LT((grbl.position() - Vec2(5, 8)).norm(), 1e-3);
  const Result<Vec2> q = stage->position();
  ASSERT_TRUE(q) << q.error().message();
  EXPECT_LT((*q - Vec2(5, 8)).norm(), 0.0026) << "half of 0.0001 inch, twice, on both axes";
}

TEST(GrblStage, LockedUntilHomed) {
  const ScriptedGrbl grbl;
  const auto stage = open(grbl);
  EXPECT_THAT(message(stage->move_to({1, 1})), HasSubstr("locked by an alarm"));
  EXPECT_THAT(message(stage->position()), HasSubstr("locked by an alarm"));
  ASSERT_TRUE(stage->home());
  EXPECT_TRUE(stage->move_to({1, 1}));
}

TEST(GrblStage, LockedWithoutHomingIsRefusedOnOpening) {
  const ScriptedGrbl grbl;
  StageSettings settings = settings_for(grbl.path());
  settings.home = false;
  const auto stage = open_stage(settings);
  ASSERT_FALSE(stage);
  EXPECT_THAT(stage.error().message(), HasSubstr("locked by an alarm"));
}

TEST(GrblStage, ASecondOwnerIsRefused) {
  const ScriptedGrbl grbl;
  const auto stage = open(grbl);
  const auto second = open_stage(settings_for(grbl.path()));
  ASSERT_FALSE(second);
  EXPECT_THAT(second.error().message(), HasSubstr("in use by another program"));
}

TEST(GrblStage, KeepsThePositionFromOneOwnerToTheNext) {
  const ScriptedGrbl grbl;
  {
    const auto stage = open_homed(grbl);
    ASSERT_TRUE(stage->move_to({4, 4}));
    stage->halt();  // leaves the controller in a hold
  }
  const auto stage = open(grbl);
  const Result<Vec2> q = stage->position();
  ASSERT_TRUE(q) << q.error().message();
  EXPECT_LT((*q - Vec2(4, 4)).norm(), 1e-3);
}

TEST(GrblStage, StopsWhatAFormerOwnerLeftMoving) {
  Script script;
  script.speed_mm_s = 20;
  const ScriptedGrbl grbl(script);
  {
    auto link = SerialLink::open(grbl.path(), 115200);
    ASSERT_TRUE(link);
    ASSERT_TRUE((*link)->write("$H\nG21 G90 G53 G0 X100 Y0\n"));
    while (grbl.state() != "Run") std::this_thread::sleep_for(milliseconds(1));
  }
  const auto stage = open(grbl);
  EXPECT_EQ(grbl.state(), "Idle") << "an alarm would mean that the position is lost";
  EXPECT_TRUE(stage->position());
}

TEST(GrblStage, WakesAControllerThatIsBlockedByAnAlarm) {
  Script script;
  script.blocked = true;
  const ScriptedGrbl grbl(script);
  EXPECT_NE(open_homed(grbl), nullptr);
}

TEST(GrblStage, StopRequestHaltsAndKeepsThePosition) {
  Script script;
  script.speed_mm_s = 20;
  const ScriptedGrbl grbl(script);
  const auto stage = open_homed(grbl);
  std::stop_source stop;
  std::jthread operator_thread([&] {
    while (grbl.position().x() < 1) std::this_thread::sleep_for(milliseconds(1));
    stop.request_stop();
  });
  const Status moved = stage->move_to({100, 0}, stop.get_token());
  ASSERT_FALSE(moved);
  EXPECT_EQ(moved.error().what, "stopped by the operator");
  const Result<Vec2> q = stage->position();
  ASSERT_TRUE(q) << q.error().message();
  EXPECT_GE(q->x(), 1);
  EXPECT_LT(q->x(), 99);
  EXPECT_TRUE(stage->move_to({0, 0})) << "usable again without homing";
}

TEST(GrblStage, HaltFromAnotherThreadEndsTheMove) {
  Script script;
  script.speed_mm_s = 20;
  const ScriptedGrbl grbl(script);
  const auto stage = open_homed(grbl);
  std::jthread other([&] {
    while (grbl.position().x() < 1) std::this_thread::sleep_for(milliseconds(1));
    stage->halt();
  });
  EXPECT_THAT(message(stage->move_to({100, 0})), HasSubstr("hold"));
  EXPECT_TRUE(stage->position());
  EXPECT_TRUE(stage->move_to({0, 0}));
}

TEST(GrblStage, StopRequestEndsHoming) {
  Script script;
  script.homing_ends = false;
  const ScriptedGrbl grbl(script);
  const auto stage = open(grbl);
  std::stop_source stop;
  std::jthread operator_thread([&] {
    while (grbl.state() != "Home") std::this_thread::sleep_for(milliseconds(1));
    stop.request_stop();
  });
  const Status homed = stage->home(stop.get_token());
  ASSERT_FALSE(homed);
  EXPECT_EQ(homed.error().what, "stopped by the operator");
  EXPECT_EQ(grbl.state(), "Alarm");
}

TEST(GrblStage, HaltFromAnotherThreadEndsHoming) {
  Script script;
  script.homing_ends = false;
  const ScriptedGrbl grbl(script);
  const auto stage = open(grbl);
  std::jthread other([&] {
    while (grbl.state() != "Home") std::this_thread::sleep_for(milliseconds(1));
    stage->halt();
  });
  EXPECT_THAT(message(stage->home()), HasSubstr("alarm 6"));
}

TEST(GrblStage, NothingMovesAfterAStopRequest) {
  const ScriptedGrbl grbl;
  const auto stage = open_homed(grbl);
  std::stop_source stop;
  stop.request_stop();
  EXPECT_FALSE(stage->move_to({5, 5}, stop.get_token()));
  EXPECT_FALSE(stage->home(stop.get_token()));
  EXPECT_EQ(grbl.position(), Vec2(0, 0));
}

struct FaultCase {
  Fault fault;
  const char* name;
  const char* words;
  bool usable_after_homing;
};

class GrblStageInMotion : public testing::TestWithParam<FaultCase> {};
INSTANTIATE_TEST_SUITE_P(Faults, GrblStageInMotion,
                         testing::Values(FaultCase{Fault::silence, "silence", "no answer within 5 s", false},
                                         FaultCase{Fault::garbage, "garbage", "unreadable answers", false},
                                         FaultCase{Fault::alarm, "alarm", "alarm 1, a limit switch was hit", true},
                                         FaultCase{Fault::door, "door", "safety door is open", false},
                                         FaultCase{Fault::hold, "hold", "put on hold", true},
                                         FaultCase{Fault::restart, "restart", "the controller restarted", true},
                                         FaultCase{Fault::unplug, "unplug", "unplugged or switched off", false}),
                         [](const auto& each) { return std::string(each.param.name); });

TEST_P(GrblStageInMotion, IsNamedWithARemedy) {
  ScriptedGrbl grbl;
  const auto stage = open_homed(grbl);
  grbl.set_fault(GetParam().fault, 2);
  const Status moved = stage->move_to({30, 0});
  ASSERT_FALSE(moved);
  EXPECT_THAT(moved.error().what, HasSubstr(GetParam().words));
  EXPECT_EQ(moved.error().where, grbl.path());
  EXPECT_FALSE(moved.error().remedy.empty());
  if (!GetParam().usable_after_homing) return;
  const Status homed = stage->home();
  ASSERT_TRUE(homed) << homed.error().message();
  EXPECT_TRUE(stage->move_to({1, 1}));
}

TEST(GrblStage, AMoveHasADeadline) {
  Script script;
  script.speed_mm_s = 5;  // while $110 says 100
  const ScriptedGrbl grbl(script);
  const auto stage = open_homed(grbl);
  EXPECT_THAT(message(stage->move_to({30, 0})), HasSubstr("did not arrive within 3.0 s"));
  const Result<Vec2> q = stage->position();
  ASSERT_TRUE(q) << q.error().message();
  EXPECT_GT(q->x(), 10);
}

TEST(GrblStage, AStageThatDoesNotStopIsToldBesideTheReason) {
  ScriptedGrbl grbl;
  const auto stage = open_homed(grbl);
  grbl.set_fault(Fault::freeze, 2);
  std::stop_source stop;
  std::jthread operator_thread([&] {
    while (grbl.position().x() < 2) std::this_thread::sleep_for(milliseconds(1));
    stop.request_stop();
  });
  const Status moved = stage->move_to({30, 0}, stop.get_token());
  EXPECT_THAT(message(moved), testing::AllOf(HasSubstr("stopped by the operator; and then: it does not stop"),
                                             HasSubstr("switch the stage off")));
}

TEST(GrblStage, AnAlarmHoldsUntilHomed) {
  ScriptedGrbl grbl;
  const auto stage = open_homed(grbl);
  grbl.set_fault(Fault::alarm, 2);
  EXPECT_FALSE(stage->move_to({30, 0}));
  EXPECT_THAT(message(stage->position()), HasSubstr("alarm 1"));
  EXPECT_THAT(message(stage->move_to({0, 0})), HasSubstr("alarm 1"));
}

TEST(GrblStage, RefusesTargetsOutOfReach) {
  const ScriptedGrbl grbl;
  const auto stage = open_homed(grbl);
  EXPECT_THAT(message(stage->move_to({250, 0})), HasSubstr("alarm 2, the target lies beyond the soft limits"));
  const std::size_t lines = grbl.lines().size();
  EXPECT_THAT(message(stage->move_to({NAN, 0})), HasSubstr("not a position"));
  EXPECT_THAT(message(stage->move_to({0, 1e300})), HasSubstr("not a position"));
  EXPECT_EQ(grbl.lines().size(), lines) << "nothing was sent";
}

TEST(GrblStage, RefusesWhatIsNoGrblStage) {
  const auto reason = [](const std::string& path) { return message(open_stage(settings_for(path))); };
  EXPECT_THAT(reason("/dev/no-such-port"), HasSubstr("there is no such device"));
  EXPECT_THAT(reason("/dev/null"), HasSubstr("not a serial line"));
  Script script;
  script.firmware = "0.9j.20160303";
  EXPECT_THAT(reason(ScriptedGrbl(script).path()), HasSubstr("not GRBL 1.1"));
}

TEST(GrblStage, SilenceAndNoiseOnOpening) {
  const Pty nobody;
  EXPECT_THAT(message(open_stage(settings_for(nobody.path()))), HasSubstr("no answer within 3 s"));
  Script script;
  script.boot_noise = "\xfe\xfe*\n";
  const ScriptedGrbl noisy(script);
  EXPECT_THAT(message(open_stage(settings_for(noisy.path()))), HasSubstr("unreadable answers"));
}

TEST(Stages, AnUnknownKindListsTheKnownOnes) {
  StageSettings settings;
  settings.kind = "hexapod";
  const auto stage = open_stage(settings);
  ASSERT_FALSE(stage);
  EXPECT_THAT(stage.error().message(), HasSubstr("\"hexapod\""));
  EXPECT_THAT(stage.error().remedy, HasSubstr("grbl"));
}

TEST(Stages, ListingDisturbsNoMotion) {
  Script script;
  script.speed_mm_s = 100;
  const ScriptedGrbl grbl(script);
  {
    auto link = SerialLink::open(grbl.path(), 115200);
    ASSERT_TRUE(link);
    ASSERT_TRUE((*link)->write("$H\nG21 G90 G53 G0 X100 Y0\n"));
    while (grbl.state() != "Run") std::this_thread::sleep_for(milliseconds(1));
  }
  const auto lines = grbl.lines();
  const auto reports = find_stages(grbl.path());
  EXPECT_TRUE(std::ranges::any_of(reports, [&](const auto& r) {
    return r.address == grbl.path() && r.usable && r.capabilities == "busy: not asked what it can";
  }));
  EXPECT_EQ(grbl.lines(), lines);
  while (grbl.state() == "Run") std::this_thread::sleep_for(milliseconds(10));
  EXPECT_EQ(grbl.state(), "Idle") << "neither in an alarm by a reset nor on hold";
  EXPECT_EQ(grbl.position(), Vec2(100, 0));
}

TEST(Stages, FindsTheGivenPort) {
  const ScriptedGrbl grbl;
  const auto found = [](const std::string& path) {
    for (const DeviceReport& report : find_stages(path))
      if (report.address == path) return report;
    return DeviceReport{};
  };
  const DeviceReport usable = found(grbl.path());
  EXPECT_TRUE(usable.usable);
  EXPECT_EQ(usable.role, "stage");
  EXPECT_EQ(usable.name, "Grbl 1.1h.20190825");
  EXPECT_EQ(usable.capabilities, "travel 200 by 150 mm; up to 83.3333 mm/s, 400 mm/s²");

  const auto owner = open(grbl);
  const DeviceReport busy = found(grbl.path());
  EXPECT_FALSE(busy.usable);
  EXPECT_THAT(busy.reason, HasSubstr("in use"));
  EXPECT_FALSE(busy.remedy.empty());
}

}  // namespace
}  // namespace lumifield
