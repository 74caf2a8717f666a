#include "tests/support/grbl_host.h"

namespace lumifield::virtual_bench {
namespace {

TEST_F(GrblControllerTest, StartsLockedAndSaysSo) {
  EXPECT_EQ(banner_, (std::vector<std::string>{"Grbl 1.1h ['$' for help]", "[MSG:'$H'|'$X' to unlock]"}));
  EXPECT_EQ(host_->report().state, "Alarm");
  EXPECT_EQ(host_->answer("G0 X1"), "error:9");
  EXPECT_EQ(host_->command("$X"), (std::vector<std::string>{"[MSG:Caution: Unlocked]", "ok"}));
  EXPECT_EQ(host_->report().state, "Idle");
}

TEST_F(GrblControllerTest, AHoldThenAResetKeepsThePosition) {
  home();
  ASSERT_EQ(host_->answer("G1 X40 F6000"), "ok");
  host_->wait_past(5);
  host_->send("!");
  const Vec2 stopped = host_->wait_for("Hold:0").mpos;
  host_->send("\x18");
  EXPECT_EQ(host_->drain(), std::vector<std::string>{"Grbl 1.1h ['$' for help]"});
  const Report report = host_->report();
  EXPECT_EQ(report.state, "Idle");
  EXPECT_EQ(report.mpos, stopped);
}

TEST_F(GrblControllerTest, AResetInMotionIsAnAlarm) {
  home();
  ASSERT_EQ(host_->answer("G1 X40 F6000"), "ok");
  host_->wait_past(5);
  host_->send("\x18");
  EXPECT_EQ(host_->drain(),
            (std::vector<std::string>{"ALARM:3", "Grbl 1.1h ['$' for help]", "[MSG:'$H'|'$X' to unlock]"}));
  EXPECT_EQ(host_->report().state, "Alarm");
  EXPECT_EQ(host_->answer("G0 X1"), "error:9");
  home();
  EXPECT_EQ(host_->report().mpos, Vec2(0, 0));
}

TEST_F(GrblControllerTest, ASoftLimitKillsIt) {
  home();
  EXPECT_EQ(host_->answer("G0 X166 Y152"), "ok");
  host_->wait_for("Idle");
  EXPECT_EQ(host_->command("G0 X166.01"), std::vector<std::string>{"ALARM:2"});
  EXPECT_EQ(host_->line(), "[MSG:Reset to continue]");
  host_->send("$X\n");
  EXPECT_EQ(host_->line(0.2), "") << "it must be dead until a reset";
  host_->send("\x18");
  EXPECT_EQ(host_->drain(), (std::vector<std::string>{"ok", "Grbl 1.1h ['$' for help]", "[MSG:'$H'|'$X' to unlock]"}));
  EXPECT_EQ(host_->answer("$X"), "ok");
  EXPECT_EQ(host_->report().mpos, Vec2(166, 152));
}

TEST_F(GrblControllerTest, ASwitchHitIsAHardLimit) {
  home();
  ASSERT_EQ(host_->answer("$20=0"), "ok");
  ASSERT_EQ(host_->answer("G1 X-10 F600"), "ok");
  EXPECT_EQ(host_->line(), "ALARM:1");
  EXPECT_EQ(host_->line(), "[MSG:Reset to continue]");
  const Report report = host_->report();
  EXPECT_EQ(report.state, "Alarm");
  EXPECT_NE(report.text.find("|Pn:X"), std::string::npos) << report.text;
  EXPECT_NEAR(controller_->true_position_mm().x(), -1, 0.1);
}

TEST_F(GrblControllerTest, WithoutHardLimitsASwitchIsOnlyToldAndTheStopIsBehindIt) {
  home();
  ASSERT_EQ(host_->answer("$20=0"), "ok");
  ASSERT_EQ(host_->answer("$21=0"), "ok");
  ASSERT_EQ(host_->answer("G0 X-1"), "ok");
  EXPECT_NE(host_->wait_for("Idle").text.find("|Pn:X"), std::string::npos);
  EXPECT_NEAR(controller_->true_position_mm().x(), -1, 1e-9);
  ASSERT_EQ(host_->answer("G0 X-10"), "ok");
  EXPECT_EQ(host_->wait_for("Idle").mpos.x(), -10);
  EXPECT_NEAR(controller_->true_position_mm().x(), -6, 1e-9) << "against the stop it loses steps";
  EXPECT_NEAR(controller_->off_mm().x(), 4, 1e-9);
}

TEST_F(GrblControllerTest, SilentItAnswersNothing) {
  controller_->silence(true);
  host_->send("?$X\n");
  EXPECT_EQ(host_->line(0.2), "");
  controller_->silence(false);
  EXPECT_EQ(host_->report().state, "Idle");
}

TEST_F(GrblControllerTest, ATrippedSwitchIsAnAlarm) {
  home();
  controller_->trip_limit();
  EXPECT_EQ(host_->line(), "ALARM:1");
  EXPECT_EQ(host_->line(), "[MSG:Reset to continue]");
}

}  // namespace
}  // namespace lumifield::virtual_bench
