#include "acquisition/scan/bench_clock.h"

#include <chrono>
#include <condition_variable>
#include <mutex>

namespace lumifield {

namespace {

class SteadyBenchClock final : public BenchClock {
 public:
  double now_s() override {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
  }

  bool wait(double seconds, std::stop_token stop) override {
    std::mutex mutex;
    std::condition_variable_any never;
    std::unique_lock lock(mutex);
    never.wait_for(lock, stop, std::chrono::duration<double>(seconds), [] { return false; });
    return !stop.stop_requested();
  }
};

}  // namespace

BenchClock& steady_bench_clock() {
  static SteadyBenchClock clock;
  return clock;
}

}  // namespace lumifield
