#pragma once

#include <chrono>
#include <csignal>
#include <gtest/gtest.h>
#include <string>
#include <thread>
#include <vector>

#include "app/cli/command_line.h"

namespace lumifield::support {

struct CommandRun {
  int code;
  std::string out, error;
};

/// `lumifield` with these arguments, without a window.
inline CommandRun run_command(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), "lumifield");
  std::vector<char*> argv;
  for (std::string& each : arguments) argv.push_back(each.data());
  argv.push_back(nullptr);
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  const int code = run_command_line(
      static_cast<int>(arguments.size()), argv.data(), [](int, char**, const WindowOptions&) { return 99; },
      [](const Study&, const std::filesystem::path&) { return Status{}; });
  std::string out = testing::internal::GetCapturedStdout();
  return {code, std::move(out), testing::internal::GetCapturedStderr()};
}

/// Stops the command, as an operator does, once it listens: SIGTERM.
class Operator {
 public:
  Operator()
      : sender_([before = handler()](const std::stop_token& over) {
          while (!over.stop_requested() && handler() == before)
            std::this_thread::sleep_for(std::chrono::milliseconds(10));
          if (!over.stop_requested()) std::raise(SIGTERM);
        }) {}
  ~Operator() {
    sender_.request_stop();
    sender_.join();
    std::signal(SIGTERM, SIG_DFL);
  }

 private:
  using Handler = void (*)(int);
  static Handler handler() {
    struct sigaction now {};
    sigaction(SIGTERM, nullptr, &now);
    return now.sa_handler;
  }
  std::jthread sender_;
};

}  // namespace lumifield::support
