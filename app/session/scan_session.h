#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <stop_token>
#include <string>
#include <variant>
#include <vector>

#include "acquisition/scan/scanner.h"
#include "app/session/bench_devices.h"
#include "app/session/bench_view.h"
#include "app/session/bounded_queue.h"
#include "app/session/prediction.h"
#include "luminaire/bench.h"
#include "luminaire/dataset.h"
#include "luminaire/plan.h"
#include "luminaire/scene.h"
#include "renderer/picture.h"

namespace lumifield {

class FrameRecording;

/// What to scan, with what, and where to.
struct ScanRequest {
  Bench bench;
  Plan plan;
  std::filesystem::path out;  ///< NAME.lumi
  bool resume = false;
  std::vector<CellIndex> retake;  ///< with `resume`: cells to take again beside those that are missing
  bool attended = false;          ///< somebody answers: a trouble pauses the scan in place of ending it
  bool accept_drift = false;      ///< the drift read first and a lamp that does not become steady are known: only
                                  ///< further drift is a trouble
  std::string name;               ///< of the luminaire; empty = the folder's stem
  std::optional<Scene> preview;
  int preview_width_px = 1024, preview_height_px = 768;
  std::vector<double> picture_shares;     ///< a picture is made when this share of the cells is in, 0 … 1
  std::shared_ptr<BenchView> bench_view;  ///< told what the bench sees, when given; brackets while it is watched
  BenchDevices devices;
  std::shared_ptr<FrameRecording> recording;  ///< of its frames (scan_recording.h): what it takes is predicted too, and
                                              ///< a notice tells when it cannot go on
};

/// Where the session's own time went, seconds, one figure per cell.
struct StageTimes {
  std::vector<double> develop_s, store_s, render_s;
  std::vector<double> kernel_s;
};

struct ScanSummary {
  std::filesystem::path dataset;
  Coverage coverage;
  int cells_before = 0;  ///< of coverage.measured: there before this scan
  ScanTiming timing;
  std::optional<ScanPrediction> prediction;  ///< as it was told before the first cell
  /// A resumed dataset was complete already: no device was opened.
  bool nothing_left() const { return cells_before == coverage.total; }
  StageTimes times;
  std::vector<ReferenceReading> references;
  /// How the wait for a steady lamp ended; empty where the plan asks for none.
  std::optional<StabilisationEnd> stabilised() const {
    return references.empty() ? std::nullopt : references.front().stabilised;
  }
  int frames_retaken = 0, cameras_lost = 0;
  int cells_with_warnings = 0;
  int cells_adapted = 0;  ///< with exposures beyond the plan's
  std::string camera, stage, opengl, opencl;
};

/// What a scan that has ended leaves on the disk.
struct ScanKept {
  int cells = 0, total = 0;  ///< of the whole grid, with those there before
  int half_cells = 0;        ///< beside them: whose other passes are to come
};

struct CellStored {
  CellEntry entry;
  std::shared_ptr<const CellImage> image;  ///< without its variance
};
/// A pass of a cell whose other passes are still to come, where the operator changes the slide.
struct PassStored {
  CellIndex cell;
  std::string pass;
  std::shared_ptr<const CellImage> image;  ///< what this pass alone makes, without its variance; of the first pass
};
struct PictureMade {
  double share = 0;
  int cells = 0;
  int half_cells = 0;  ///< of them: with the first pass alone
  Picture picture;
};
struct Notice {
  std::string text;
};
/// ScanPrediction comes once, when the devices are open.
using SessionEvent =
    std::variant<ScanPrediction, ScanProgress, CellStored, PassStored, ReferenceReading, PictureMade, Notice>;

/// One scan from photons to a durable dataset and a picture: four threads, joined by bounded queues.
///
///     bench (camera, stage) → 2 raw cells → develop → 4 cells → store (durable) → 4 cells → render → pictures
///
/// Where the operator changes the slide, develop keeps a pass as a half cell (app/session/pass_by_pass.h) and hands on
/// what it makes alone; with the last pass the cell goes on as any other. The scan asks for the next slide as Scanner
/// says.
///
/// Everything is checked before anything moves. A complete dataset that is resumed is left as it is, without a picture;
/// only the journal of a scan that was killed at its end is still merged into its manifest. Cells are never dropped;
/// progress events, all but the last, are when nobody takes them. `start` returns when the threads run; take events
/// until they end, then `wait`. Thread-safe but for `wait`, called once.
class ScanSession {
 public:
  /// Errors before anything moves: plan against bench, output folder, a dataset to resume that is not there or was
  /// measured otherwise, preview. A dataset to resume is then as it was before.
  static Result<std::unique_ptr<ScanSession>> start(ScanRequest request);
  /// Stops the scan and joins.
  ~ScanSession();

  const LuminaireGeometry& geometry() const;
  /// The next event; empty when the session has ended.
  std::optional<SessionEvent> next_event();
  /// Halts the stage and ends, in a pause too; what is stored stays.
  void stop();
  /// After the cell at hand, until `resume`.
  void pause();
  void resume();
  /// Takes these cells again, next. Their earlier generation counts until the new one is stored.
  void retake(std::span<const CellIndex> cells);
  /// Joins all threads. The Error of the first stage that failed, if one did; its `kind` is `stopped` when the operator
  /// ended the scan.
  Result<ScanSummary> wait();
  /// After `wait`.
  ScanKept kept() const;

 private:
  struct Impl;
  explicit ScanSession(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace lumifield
