#pragma once

#include <stop_token>

namespace lumifield {

/// The clock of the bench and its waits. A role, so that a test drives a whole scan by hand without waiting.
/// Thread-bound to the bench thread.
class BenchClock {
 public:
  virtual ~BenchClock() = default;

  /// Monotonic, from an arbitrary origin.
  virtual double now_s() = 0;

  /// False when a stop request cut the wait short.
  virtual bool wait(double seconds, std::stop_token stop) = 0;
};

/// The machine's steady clock.
BenchClock& steady_bench_clock();

}  // namespace lumifield
