#include <chrono>
#include <cmath>
#include <thread>

#include "acquisition/virtual/motion.h"
#include "tests/support/grbl_host.h"

namespace lumifield::virtual_bench {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

TEST_F(GrblControllerTest, HomesToTheSwitchesAndCountsFromThere) {
  const Vec2 before = controller_->true_position_mm();
  EXPECT_EQ(before, options_.power_up_mm);
  host_->send("$H\n");
  host_->wait_for("Home");
  EXPECT_EQ(host_->line(20), "ok");
  const Report homed = host_->report();
  EXPECT_EQ(homed.state, "Idle");
  EXPECT_EQ(homed.mpos, Vec2(0, 0));
  EXPECT_EQ(controller_->true_position_mm(), Vec2(0, 0));
}

TEST_F(GrblControllerTest, UnlockedWithoutHomingItDoesNotKnowWhereItIs) {
  ASSERT_EQ(host_->answer("$X"), "ok");
  EXPECT_EQ(host_->report().mpos, Vec2(0, 0));
  seconds_to_idle("G0 X10");
  EXPECT_EQ(host_->report().mpos, Vec2(10, 0));
  EXPECT_EQ(controller_->true_position_mm(), Vec2(13, 2));
}

TEST_F(GrblControllerTest, MovesWhereItIsToldInStepsAndTellsTheWorld) {
  home();
  seconds_to_idle("G90 G21 G53 G0 X12.3457 Y7.5");
  const Report report = host_->report();
  EXPECT_NEAR(report.mpos.x(), 12.344, 1e-9);  // 3086 steps of 4 µm
  EXPECT_NEAR(report.mpos.y(), 7.5, 1e-9);
  ASSERT_EQ(prepared_.size(), 1u);
  EXPECT_LT((prepared_[0] - controller_->true_position_mm()).norm(), 1e-9);
  EXPECT_LT((controller_->true_position_mm() - Vec2(12.344, 7.5)).norm(), 1e-9);
}

TEST(Trapezoid, IsTheIntegralOfItsSpeed) {
  const Trapezoid cases[] = {{120, 80, 400}, {4, 80, 400}, Trapezoid::braking(80, 400)};
  for (const Trapezoid& move : cases) {
    const int steps = 20000;
    const double dt = move.duration_s() / steps;
    double way = 0;
    for (int i = 0; i < steps; ++i) {
      const double t = (i + 0.5) * dt;
      way += move.at(t).mm_s * dt;
      EXPECT_NEAR(move.at((i + 1) * dt).mm, way, 1e-3);
    }
    EXPECT_NEAR(way, move.length_mm(), 1e-3);
    EXPECT_EQ(move.at(move.duration_s()).mm, move.length_mm());
  }
  // L/v + v/a where it cruises, else 2 √(L/a); v/a to brake, over v²/2a.
  EXPECT_NEAR(cases[0].duration_s(), 120 / 80. + 80 / 400., 1e-12);
  EXPECT_NEAR(cases[1].duration_s(), 2 * std::sqrt(4 / 400.), 1e-12);
  EXPECT_NEAR(cases[2].duration_s(), 80 / 400., 1e-12);
  EXPECT_NEAR(cases[2].length_mm(), 80 * 80 / 800., 1e-12);
  EXPECT_EQ(cases[2].at(0).mm_s, 80);
  EXPECT_EQ(Trapezoid(0, 80, 400).duration_s(), 0);
}

TEST_F(GrblControllerTest, MovesTakeTheirTime) {
  options_.rapid_mm_s = 80;
  options_.acceleration_mm_s2 = 400;
  start();
  home();

  // The diagonal is limited by its x axis.
  const std::pair<const char*, double> moves[] = {{"G0 X40", 40 / 80. + 80 / 400.},
                                                  {"G91 G0 X-40 Y20", 40 / 80. + 80 / 400.},
                                                  {"G1 X10 F1200", 10 / 20. + 20 / 400.}};
  for (const auto& [line, expected_s] : moves) {
    const double ratio = seconds_to_idle(line) / expected_s;
    EXPECT_GE(ratio, 0.999) << line;
    EXPECT_LE(ratio, 2) << line;
  }
}

TEST_F(GrblControllerTest, ReportsPositionAndSpeedOnTheWay) {
  home();
  ASSERT_EQ(host_->answer("G1 X40 F6000"), "ok");
  double last = 0;
  bool cruised = false;
  for (Report now = host_->report(); now.state == "Run"; now = host_->report()) {
    EXPECT_GE(now.mpos.x(), last);
    EXPECT_LE(now.mpos.x(), 40);
    last = now.mpos.x();
    cruised |= now.text.find("|FS:6000,") != std::string::npos;
  }
  EXPECT_TRUE(cruised);
}

TEST_F(GrblControllerTest, TakesFifteenMovesBeforeItMakesTheHostWait) {
  home();
  std::string lines;
  for (int i = 1; i <= 17; ++i) lines += "G1X" + std::to_string(i) + "F60\n";
  host_->send(lines);
  int taken = 0;
  while (host_->line(0.3) == "ok") ++taken;
  EXPECT_EQ(taken, 15);
  host_->send("\x18");
  EXPECT_EQ(host_->line(), "ALARM:3");
}

TEST_F(GrblControllerTest, HoldsAndResumes) {
  home();
  ASSERT_EQ(host_->answer("G1 X40 F6000"), "ok");
  host_->wait_past(5);
  host_->send("!");
  const Vec2 stopped = host_->wait_for("Hold:0").mpos;
  EXPECT_GT(stopped.x(), 5);
  EXPECT_LT(stopped.x(), 39);
  std::this_thread::sleep_for(milliseconds(100));
  EXPECT_EQ(host_->report().mpos, stopped);
  host_->send("~");
  EXPECT_EQ(host_->wait_for("Idle").mpos, Vec2(40, 0));
}

TEST_F(GrblControllerTest, LosesStepsThatItsReadingDoesNotShow) {
  home();
  controller_->lose_steps(0.5);
  seconds_to_idle("G0 X50");
  EXPECT_EQ(host_->report().mpos, Vec2(50, 0));
  EXPECT_NEAR(controller_->true_position_mm().x(), 49.5, 1e-9);
  EXPECT_NEAR(prepared_.back().x(), 49.5, 1e-9);
  seconds_to_idle("G0 Y30");
  EXPECT_LT((controller_->true_position_mm() - Vec2(49.5, 29.5)).norm(), 1e-9);
  seconds_to_idle("G0 X52");
  EXPECT_NEAR(controller_->off_mm().x(), -0.5, 1e-9) << "2 mm are too short to get fast";
  controller_->lose_steps(0);
  home();
  EXPECT_EQ(controller_->true_position_mm(), Vec2(0, 0));
}

TEST_F(GrblControllerTest, StuckItSaysRunAndStandsStill) {
  home();
  ASSERT_EQ(host_->answer("G1 X40 F6000"), "ok");
  host_->wait_past(5);
  controller_->stick(true);
  const Report stuck = host_->report();
  std::this_thread::sleep_for(milliseconds(100));
  EXPECT_EQ(host_->report().state, "Run");
  EXPECT_EQ(host_->report().mpos, stuck.mpos);
  controller_->stick(false);
  EXPECT_EQ(host_->wait_for("Idle").mpos, Vec2(40, 0));
}

TEST_F(GrblControllerTest, ADwellIsAnsweredWhenItIsOver) {
  home();
  const auto begin = Clock::now();
  EXPECT_EQ(host_->answer("G4 P0.3"), "ok");
  EXPECT_GE(Clock::now() - begin, milliseconds(300));
}

}  // namespace
}  // namespace lumifield::virtual_bench
