#pragma once

#include <chrono>
#include <cmath>
#include <cstdio>
#include <fcntl.h>
#include <filesystem>
#include <gtest/gtest.h>
#include <memory>
#include <poll.h>
#include <string>
#include <termios.h>
#include <unistd.h>
#include <vector>

#include "acquisition/virtual/grbl_controller.h"

namespace lumifield::virtual_bench {

/// A status report: its text, and what it says.
struct Report {
  std::string state, text;
  Vec2 mpos{NAN, NAN};
};

/// A bare terminal client.
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

  /// One line, or "" when none came in time.
  std::string line(double timeout_s = 2) {
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::duration<double>(timeout_s);
    for (std::string text;;) {
      pollfd ready{file_, POLLIN, 0};
      const auto left =
          std::chrono::ceil<std::chrono::milliseconds>(deadline - std::chrono::steady_clock::now()).count();
      char c = 0;
      if (left <= 0 || poll(&ready, 1, int(left)) <= 0 || read(file_, &c, 1) != 1) return text;
      if (c == '\n') {
        if (!text.empty()) return text;
      } else if (c != '\r') {
        text += c;
      }
    }
  }
  /// All lines up to the answer of a command.
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
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::duration<double>(timeout_s);
    Report now = report();
    while (now.state != state && std::chrono::steady_clock::now() < deadline) now = report();
    EXPECT_EQ(now.state, state);
    return now;
  }
  void wait_past(double x_mm) {
    for (Report now = report(); !(now.mpos.x() > x_mm); now = report()) ASSERT_EQ(now.state, "Run");
  }
  /// Reads until nothing comes.
  std::vector<std::string> drain() {
    std::vector<std::string> lines;
    for (std::string got; !(got = line(0.1)).empty();) lines.push_back(got);
    return lines;
  }

 private:
  int file_;
};

/// A virtual controller with a host on its line.
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
    const auto begin = std::chrono::steady_clock::now();
    EXPECT_EQ(host_->answer(move), "ok");
    host_->wait_for("Idle", 30);
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  }

  std::filesystem::path folder_;
  GrblOptions options_;
  std::vector<Vec2> prepared_;
  std::unique_ptr<GrblController> controller_;
  std::unique_ptr<Host> host_;
  std::vector<std::string> banner_;
};

}  // namespace lumifield::virtual_bench
