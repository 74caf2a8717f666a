#pragma once

#include "acquisition/scan/bench_clock.h"
#include "luminaire/error.h"

namespace lumifield {

/// Adds the time until its end to one part of a scan's timing.
class Stretch {
 public:
  Stretch(BenchClock& clock, double& part_s) : clock_(clock), part_s_(part_s), begin_s_(clock.now_s()) {}
  ~Stretch() { part_s_ += clock_.now_s() - begin_s_; }
  Stretch(const Stretch&) = delete;
  Stretch& operator=(const Stretch&) = delete;

 private:
  BenchClock& clock_;
  double& part_s_;
  double begin_s_;
};

/// How a scan ends that the operator stopped.
inline tl::unexpected<Error> scan_stopped() {
  return tl::unexpected<Error>({"stopped by the operator", "scan", {}, ErrorKind::stopped});
}

}  // namespace lumifield
