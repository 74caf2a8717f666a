#include "app/cli/stop_on_signal.h"

#include <ctime>
#include <unistd.h>
#include <utility>

namespace lumifield {

sigset_t StopOnSignal::block() {
  sigset_t signals;
  sigemptyset(&signals);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) sigaddset(&signals, signal);
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  return signals;
}

StopOnSignal::StopOnSignal(const sigset_t& signals, std::function<void()> stop)
    : thread_([signals, stop = std::move(stop)](std::stop_token ended) {
        const timespec tick{0, 100'000'000};
        for (int taken = 0; !ended.stop_requested();) {
          const int signal = sigtimedwait(&signals, nullptr, &tick);
          if (signal <= 0) continue;
          if (++taken > 1) _exit(128 + signal);
          stop();
        }
      }) {}

}  // namespace lumifield
