#pragma once

#include <atomic>
#include <memory>
#include <optional>
#include <thread>

#include "app/session/bench_devices.h"
#include "app/session/bench_view.h"
#include "luminaire/bench.h"

namespace lumifield {

/// Watches the bench while nothing is scanned, in a thread of its own: opens camera and stage, takes a picture five
/// times a second, reads the stage's position back, and leaves all of it in a BenchView. Moves nothing. A device that
/// fails is shown as failed and tried again every two seconds. The devices are free once it is destroyed.
class BenchWatch {
 public:
  /// Begins once `before` has let go of its devices, in the new thread. Without a bench that is all it does.
  BenchWatch(std::optional<Bench> bench, double exposure_s, std::shared_ptr<BenchView> view,
             std::unique_ptr<BenchWatch> before = nullptr, BenchDevices devices = {});
  /// Joins: up to an exposure, and some seconds when the camera's link is lost.
  ~BenchWatch();

  void set_exposure(double exposure_s) { exposure_s_ = exposure_s; }

 private:
  void run(std::stop_token stop);

  const std::optional<Bench> bench_;
  std::atomic<double> exposure_s_;
  const std::shared_ptr<BenchView> view_;
  const BenchDevices devices_;
  std::unique_ptr<BenchWatch> before_;
  std::jthread thread_;
};

}  // namespace lumifield
