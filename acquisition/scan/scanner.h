#pragma once

#include <stop_token>
#include <string>

#include "acquisition/camera.h"
#include "acquisition/scan/scan_plan.h"
#include "acquisition/stage.h"

namespace lumifield {

enum class ScanState { idle, homing, moving, settling, exposing, delivering, parking, done, stopped, failed };
std::string_view to_string(ScanState state);

struct ScanProgress {
  ScanState state = ScanState::idle;
  int cells_done = 0, cells_total = 0;
  CellIndex cell;            ///< the one being worked on
  double elapsed_s = 0, left_s = 0;
};

/// Where the scan's time went. Everything but move, settle, exposure and readout is idle time of the bench.
struct ScanTiming {
  double move_s = 0, settle_s = 0, exposure_s = 0, readout_s = 0, waiting_s = 0, other_s = 0, total_s = 0;
  double idle_share() const { return total_s > 0 ? 1 - (move_s + settle_s + exposure_s + readout_s) / total_s : 0; }
};

/// Takes what the scanner makes, on the bench thread. `cell` may block when those behind it are busy: the time counts as
/// waiting.
class ScanSink {
 public:
  virtual ~ScanSink() = default;
  virtual void cell(RawCell raw) = 0;
  virtual void reference(const ReferenceReading& reading) = 0;
  virtual void progress(const ScanProgress& progress) = 0;
};

/// Runs a ScanPlan on a camera and a stage.
///
///     idle → homing → moving → settling → exposing → delivering → (next step: moving | last: parking → done)
///     any state → stopped (stop requested) | failed (a device error); both halt the stage first
///
/// It exposes only after the position was read back, lies within the bench's tolerance, and the settle time has passed;
/// a position off by more is moved to once more and then fails the scan. The reference cell comes first, every N cells and
/// last, its drift is recorded and handed on; a dark set opens every block of cells. Thread-bound to the bench thread.
class Scanner {
 public:
  Scanner(Camera& camera, Stage& stage, const Bench& bench, const Plan& plan);

  /// Runs all steps. The Error of a stop request has `what` = "stopped by the operator".
  Status run(const ScanPlan& steps, ScanSink& sink, std::stop_token stop);

  ScanState state() const { return state_; }
  const ScanTiming& timing() const { return timing_; }

 private:
  Camera& camera_;
  Stage& stage_;
  const Bench& bench_;
  const Plan& plan_;
  ScanState state_ = ScanState::idle;
  ScanTiming timing_;
};

}  // namespace lumifield
