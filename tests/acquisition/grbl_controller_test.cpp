#include "acquisition/virtual/grbl_controller.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <fcntl.h>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <poll.h>
#include <termios.h>
#include <thread>
#include <unistd.h>
#include <vector>

#include "acquisition/virtual/motion.h"

namespace lumifield::virtual_bench {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

struct Report {
  std::string state, text;
  Vec2 mpos{NAN, NAN};
};

// A bare terminal client.
class Host {
 public:
  explicit Host(const std::filesystem::path& path) : file_(open(path.c_str(), O_RDWR | O_NOCTTY)) {
    termios raw{};
    tcgetattr(file_, &raw);
    cfmakeraw(&raw);
    cfsetspeed(&raw, B115200);
    tcsetattr(file_, TCSANOW, &raw);
  }
  ~Host() { close(file_); }
  Host(const Host&) = delete;
  Host& operator=(const Host&) = delete;

  void send(const std::string& text) { ASSERT_EQ(write(file_, text.data(), text.size()), ssize_t(text.size())); }

  // One line, or "" when none came in time.
  std::string line(double timeout_s = 2) {
    const auto deadline = Clock::now() + std::chrono::duration<double>(timeout_s);
    for (std::string text;;) {
      pollfd ready{file_, POLLIN, 0};
      const auto left = std::chrono::ceil<milliseconds>(deadline - Clock::now()).count();
      char c = 0;
      if (left <= 0 || poll(&ready, 1, int(left)) <= 0 || read(file_, &c, 1) != 1) return text;
      if (c == '\n') {
        if (!text.empty()) return text;
      } else if (c != '\r') {
        text += c;
      }
    }
  }
  // All lines up to the answer of a command.
  std::vector<std::string> command(const std::string& text, double timeout_s = 10) {
    send(text + "\n");
    std::vector<std::string> lines;
    for (std::string got; !(got = line(timeout_s)).empty();) {
      lines.push_back(got);
      if (got == "ok" || got.starts_with("error:") || got.starts_with("ALARM:")) break;
    }
    return lines;
  }
  std::string answer(const std::string& text, double timeout_s = 10) {
    const auto lines = command(text, timeout_s);
    return lines.empty() ? "" : lines.back();
  }
  Report report() {
    send("?");
    Report report;
    report.text = line();
    char state[16] = "";
    std::sscanf(report.text.c_str(), "<%15[^|]|MPos:%lf,%lf", state, &report.mpos.x(), &report.mpos.y());
    report.state = state;
    return report;
  }
  Report wait_for(const std::string& state, double timeout_s = 10) {
    const auto deadline = Clock::now() + std::chrono::duration<double>(timeout_s);
    Report now = report();
    while (now.state != state && Clock::now() < deadline) now = report();
    EXPECT_EQ(now.state, state);
    return now;
  }
  void wait_past(double x_mm) {
    for (Report now = report(); !(now.mpos.x() > x_mm); now = report()) ASSERT_EQ(now.state, "Run");
  }
  // Reads until nothing comes.
  std::vector<std::string> drain() {
    std::vector<std::string> lines;
    for (std::string got; !(got = line(0.1)).empty();) lines.push_back(got);
    return lines;
  }

 private:
  int file_;
};

class GrblControllerTest : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::temp_directory_path() / ("lumifield-grbl-" + std::to_string(getpid()));
    std::filesystem::create_directory(folder_);
    options_.path = folder_ / "stage";
    options_.travel_mm = {166, 152};
    options_.power_up_mm = {3, 2};
    start();
  }
  void TearDown() override {
    host_.reset();
    controller_.reset();
    EXPECT_FALSE(std::filesystem::exists(std::filesystem::symlink_status(options_.path)));
    std::filesystem::remove_all(folder_);
  }
  void start() {
    host_.reset();
    controller_.reset();
    auto controller = GrblController::start(options_, [this](const Vec2& at) { prepared_.push_back(at); });
    ASSERT_TRUE(controller) << controller.error().message();
    controller_ = std::move(*controller);
    host_ = std::make_unique<Host>(options_.path);
    banner_ = host_->drain();
  }
  void home() { ASSERT_EQ(host_->answer("$H"), "ok"); }
  double seconds_to_idle(const std::string& move) {
    const auto begin = Clock::now();
    EXPECT_EQ(host_->answer(move), "ok");
    host_->wait_for("Idle", 30);
    return std::chrono::duration<double>(Clock::now() - begin).count();
  }

  std::filesystem::path folder_;
  GrblOptions options_;
  std::vector<Vec2> prepared_;
  std::unique_ptr<GrblController> controller_;
  std::unique_ptr<Host> host_;
  std::vector<std::string> banner_;
};

TEST_F(GrblControllerTest, StartsLockedAndSaysSo) {
  EXPECT_EQ(banner_, (std::vector<std::string>{"Grbl 1.1h ['$' for help]", "[MSG:'$H'|'$X' to unlock]"}));
  EXPECT_EQ(host_->report().state, "Alarm");
  EXPECT_EQ(host_->answer("G0 X1"), "error:9");
  EXPECT_EQ(host_->command("$X"), (std::vector<std::string>{"[MSG:Caution: Unlocked]", "ok"}));
  EXPECT_EQ(host_->report().state, "Idle");
}

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
  const Trapezoid cases[] = {{120, 80, 400}, {4, 80, 400}, {50, 80, 400, 30}, {10, 20, 400, 80}, {8, 80, 400, 80}};
  for (const Trapezoid& move : cases) {
    const int steps = 20000;
    const double dt = move.duration_s() / steps;
    double way = 0;
    for (int i = 0; i < steps; ++i) {
      const double t = (i + 0.5) * dt;
      way += move.speed_mm_s(t) * dt;
      EXPECT_NEAR(move.distance_mm((i + 1) * dt), way, 1e-3);
    }
    EXPECT_NEAR(way, move.length_mm(), 1e-3);
    EXPECT_EQ(move.distance_mm(move.duration_s()), move.length_mm());
  }
  // L/v + v/a where it cruises, else 2 √(L/a).
  EXPECT_NEAR(cases[0].duration_s(), 120 / 80. + 80 / 400., 1e-12);
  EXPECT_NEAR(cases[1].duration_s(), 2 * std::sqrt(4 / 400.), 1e-12);
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

TEST_F(GrblControllerTest, AnswersBadLinesAsGrblDoes) {
  home();
  const std::pair<const char*, const char*> cases[] = {{"X", "error:2"},
                                                       {"5", "error:1"},
                                                       {"G0 X1 X2", "error:25"},
                                                       {"G0 G1 X1", "error:21"},
                                                       {"G1 X1", "error:22"},
                                                       {"G2 X1 F10", "error:20"},
                                                       {"G0 Z1", "error:20"},
                                                       {"M3", "error:20"},
                                                       {"G1 X1 F-1", "error:4"},
                                                       {"G80 X1", "error:31"},
                                                       {"G92", "error:26"},
                                                       {"G10 X1", "error:28"},
                                                       {"G0 G92 X1", "error:24"},
                                                       {"G0 X1 P2", "error:36"},
                                                       {"$999=1", "error:3"},
                                                       {"$110=x", "error:2"},
                                                       {"$110=0", "error:4"},
                                                       {"$Q", "error:3"},
                                                       {"G0 X1e9999", "error:20"},
                                                       {"G0 X123456789012", "error:2"},
                                                       {"$110=1000000000000", "error:2"},
                                                       {"G0 Xnan", "error:2"},
                                                       {"G999999", "error:20"}};
  for (const auto& [line, answer] : cases) EXPECT_EQ(host_->answer(line), answer) << line;
  EXPECT_EQ(host_->answer(std::string(100, 'G')), "error:11");
  EXPECT_EQ(host_->answer("(a comment) ; and more"), "ok");
  EXPECT_EQ(host_->report().mpos, Vec2(0, 0));
}

TEST_F(GrblControllerTest, KnowsItsSettings) {
  const auto list = host_->command("$$");
  EXPECT_EQ(list.size(), 35u);
  EXPECT_NE(std::ranges::find(list, "$110=12000.000"), list.end());
  EXPECT_NE(std::ranges::find(list, "$120=2000.000"), list.end());
  EXPECT_NE(std::ranges::find(list, "$130=166.000"), list.end());
  EXPECT_EQ(host_->answer("$110=3000"), "ok");
  const auto changed = host_->command("$$");
  EXPECT_NE(std::ranges::find(changed, "$110=3000.000"), changed.end());
  EXPECT_TRUE(host_->command("$I")[0].starts_with("[VER:1.1h"));
  ASSERT_EQ(host_->answer("$20=0"), "ok");
  ASSERT_EQ(host_->answer("$22=0"), "ok");
  EXPECT_EQ(host_->answer("$H"), "error:5");
  EXPECT_EQ(host_->answer("$20=1"), "error:10");
}

TEST_F(GrblControllerTest, OffsetsChangeWorkPositionsOnly) {
  home();
  seconds_to_idle("G0 X20 Y10");
  ASSERT_EQ(host_->answer("G10 L20 P1 X0 Y0"), "ok");
  ASSERT_EQ(host_->answer("G92 X1"), "ok");
  EXPECT_EQ(host_->report().mpos, Vec2(20, 10));
  seconds_to_idle("G0 X5 Y5");  // work: 20 − 1 + 5, 10 + 5
  EXPECT_EQ(host_->report().mpos, Vec2(24, 15));
  ASSERT_EQ(host_->answer("$10=0"), "ok");
  host_->send("?");
  EXPECT_NE(host_->line().find("WPos:5.000,5.000"), std::string::npos);
  ASSERT_EQ(host_->answer("$10=1"), "ok");
  seconds_to_idle("G20 G91 G53 G0 X1");
  EXPECT_NEAR(host_->report().mpos.x(), 25.4, 2e-3);
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

TEST_F(GrblControllerTest, ADwellIsAnsweredWhenItIsOver) {
  home();
  const auto begin = Clock::now();
  EXPECT_EQ(host_->answer("G4 P0.3"), "ok");
  EXPECT_GE(Clock::now() - begin, milliseconds(300));
}

TEST_F(GrblControllerTest, AnotherHostMayComeAfterTheFirst) {
  home();
  host_.reset();
  host_ = std::make_unique<Host>(options_.path);
  EXPECT_EQ(host_->report().state, "Idle");
}

TEST_F(GrblControllerTest, DoesNotReplaceWhatIsThere) {
  GrblOptions taken;
  taken.path = folder_ / "taken";
  std::ofstream(taken.path) << "mine";
  const auto second = GrblController::start(taken);
  ASSERT_FALSE(second);
  EXPECT_EQ(second.error().where, taken.path.string());
  EXPECT_TRUE(std::filesystem::exists(taken.path));
}

}  // namespace
}  // namespace lumifield::virtual_bench
