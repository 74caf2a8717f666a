#include "app/session/beside.h"

#include <condition_variable>
#include <mutex>
#include <thread>
#include <utility>

#include "app/session/guarded.h"

namespace lumifield {

namespace {

struct Running {
  std::mutex mutex;
  std::condition_variable ended;
  int count = 0;
};

/// Never destroyed: a thread that hangs may end after main.
Running& running() {
  static Running& all = *new Running;
  return all;
}

void tell(const char* where, const std::function<void(const Error&)>& failed, const Error& error) {
  static_cast<void>(guarded(where, [&]() -> Status {
    failed(error);
    return {};
  }));
}

void run_and_tell(const char* where, std::function<void()> work, const std::function<void(const Error&)>& failed) {
  const Status done = guarded(where, [&]() -> Status {
    std::exchange(work, nullptr)();
    return {};
  });
  if (!done) tell(where, failed, done.error());
}

}  // namespace

void run_beside(const char* where, std::function<void()> work, std::function<void(const Error&)> failed) {
  const auto count = [](int change) {
    const std::lock_guard lock(running().mutex);
    running().count += change;
    running().ended.notify_all();
  };
  count(1);
  const Status begun = guarded(where, [&]() -> Status {
    std::thread([where, work = std::move(work), failed]() mutable {
      run_and_tell(where, std::exchange(work, nullptr), failed);
      failed = nullptr;
      std::unique_lock lock(running().mutex);
      --running().count;
      std::notify_all_at_thread_exit(running().ended, std::move(lock));
    }).detach();
    return {};
  });
  if (begun) return;
  count(-1);
  tell(where, failed, begun.error());
}

bool beside_ended(std::chrono::milliseconds limit) {
  std::unique_lock lock(running().mutex);
  return running().ended.wait_for(lock, limit, [] { return running().count == 0; });
}

}  // namespace lumifield
