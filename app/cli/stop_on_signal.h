#pragma once

#include <csignal>
#include <functional>
#include <thread>

namespace lumifield {

/// SIGINT, SIGTERM and SIGHUP (a lost terminal) call `stop`; a second one ends the program at once. They are blocked in
/// every thread, so that the one of this class alone takes them.
class StopOnSignal {
 public:
  /// Before any other thread is started.
  static sigset_t block();
  StopOnSignal(const sigset_t& signals, std::function<void()> stop);

 private:
  std::jthread thread_;
};

}  // namespace lumifield
