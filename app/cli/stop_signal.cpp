#include "app/cli/stop_signal.h"

#include <atomic>
#include <csignal>
#include <string_view>
#include <unistd.h>

namespace lumifield {

namespace {

/// A signal may be taken by any thread.
std::atomic<int> signalled = 0;
static_assert(std::atomic<int>::is_always_lock_free, "a handler may not wait");

/// Of what a handler may do: a file that takes no more is no matter here.
void take_signal(int signal) {
  constexpr std::string_view answer = "\nlumifield: stopping; once more ends it at once\n";
  signalled = 1;
  std::signal(signal, SIG_DFL);
  [[maybe_unused]] const ssize_t written = write(STDERR_FILENO, answer.data(), answer.size());
}

}  // namespace

void stop_on_signals() {
  signalled = 0;
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) std::signal(signal, take_signal);
}

bool stop_wished() { return signalled != 0; }

tl::unexpected<Error> stopped_by_operator(std::string what) {
  return tl::unexpected<Error>({"stopped by the operator", std::move(what), "", ErrorKind::stopped});
}

}  // namespace lumifield
