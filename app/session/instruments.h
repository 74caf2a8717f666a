#pragma once

#include <string>
#include <thread>

#include "acquisition/scan/device_recovery.h"
#include "app/session/bench_devices.h"
#include "app/session/bench_view.h"
#include "luminaire/bench.h"

namespace lumifield {

/// The bench's camera and stage, opened as its file says, and again when the scan asks for it. Shows `view` how each is
/// connected. Thread-bound to the bench thread; bench and view outlive it.
///
/// A camera whose link is lost may take 7 s to let go of: that happens on a thread of its own, beside the new one.
class Instruments final : public DeviceRecovery {
 public:
  Instruments(const Bench& bench, const BenchDevices& devices, BenchView& view);
  ~Instruments() override;

  /// Both. Errors: those of opening them.
  Status open();

  Camera& camera() override { return *camera_; }
  Stage& stage() override { return *stage_; }
  Status reopen_camera() override;
  Status reopen_stage() override;

  /// Of all cameras opened.
  int frames_retaken() const { return frames_retaken_ + camera_->frames_retaken(); }

 private:
  Status open_camera();
  Status open_stage();

  const Bench& bench_;
  BenchDevices devices_;
  BenchView& view_;
  std::unique_ptr<Camera> camera_;
  std::unique_ptr<Stage> stage_;
  int frames_retaken_ = 0;
  std::jthread letting_go_;
};

}  // namespace lumifield
