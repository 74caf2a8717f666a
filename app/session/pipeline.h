#pragma once

#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
#include <vector>

#include "app/session/bounded_queue.h"
#include "app/session/pass_by_pass.h"
#include "app/session/scan_session.h"
#include "calibration/develop.h"
#include "luminaire/raw_image.h"
#include "renderer/renderer.h"

namespace lumifield {

/// The way of a cell through a session. Each stage below is one function from its input queue to its output queue, run
/// by one thread; it closes its input and its output when it ends, so that the end of the scan runs down the line and
/// the failure of a stage both ways. None lets an exception out.

struct DevelopedCell {
  CellIndex cell;
  CellImage image;
  Vec2 stage_mm;
};

struct StoredCell {
  CellIndex cell;
  std::shared_ptr<const CellImage> image;
  bool half = false;  ///< the first pass alone
};

/// The queues, and the one place where the first failure of any stage and the first reading are kept. Thread-safe.
class Pipeline {
 public:
  BoundedQueue<RawCell> raw{2};
  BoundedQueue<DevelopedCell> developed{4};
  BoundedQueue<StoredCell> stored{4};
  BoundedQueue<SessionEvent> events{256};
  ScanControl control;

  /// Keeps the first error and has the bench end and park. A later fault becomes a notice.
  void fail(Error error);
  std::optional<Error> error() const;
  /// Keeps the first reading of the reference cell through each pass. The bench tells it before it hands on a cell.
  void tell_reading(const ReferenceReading& reading);
  std::optional<ReferenceReading> first_reading(int pass = 0) const;
  /// By the operator: the stage halts where it is.
  void request_stop() { stop_.request_stop(); }
  std::stop_token stop_token() const { return stop_.get_token(); }
  std::stop_token abandon_token() const { return abandon_.get_token(); }

 private:
  std::stop_source stop_, abandon_;
  mutable std::mutex mutex_;
  std::optional<Error> error_;
  std::map<int, ReferenceReading> first_readings_;
};

/// What the bench thread finds out beside the cells.
struct BenchOutcome {
  std::optional<ScanPrediction> prediction;  ///< once the devices are open
  ScanTiming timing;
  std::vector<ReferenceReading> references;
  std::string camera, stage;
  int frames_retaken = 0, cameras_lost = 0;
};

/// Opens camera and stage, runs the scan, and lets go of them. `first` are the readings that the drift refers to, by
/// pass; where one is absent, the scan's own first.
void run_bench(const ScanRequest& request, const ScanPlan& steps, const std::map<int, ReferenceReading>& first,
               Pipeline& pipeline, BenchOutcome& outcome);

/// Where the operator changes the slide: what keeps the passes; `record` makes durable what they refer to, before the
/// first of each pass; `shows`: half cells that are there already are handed on too, for a preview. `failed` tells that
/// the disk refused.
struct HalfWay {
  PassByPass& passes;
  std::function<Status()> record;
  bool shows = false;
  bool failed = false;
};

/// `half_way` null: all passes come together.
void run_develop(Developer& developer, Pipeline& pipeline, std::vector<double>& develop_s, int& cells_with_warnings,
                 int& cells_adapted, HalfWay* half_way = nullptr);

/// Hands `notes` to the operator, then stores. `record` makes durable what the cells refer to; it is called once,
/// before the first cell is stored. On a full disk it waits for room. `failed` tells that the disk refused either: the
/// dataset is left as it is, journal and all. What it hands on has no variance.
void run_store(DatasetWriter& writer, const std::vector<std::string>& notes, const std::function<Status()>& record,
               Pipeline& pipeline, std::vector<double>& store_s, bool& failed);

/// With a renderer: adds each cell and makes a picture when the next of `shares` of `total` cells is in; `already`
/// cells were added before. Without one it lets the cells pass. A preview that fails ends with a notice; the scan goes
/// on.
void run_render(Renderer* renderer, int already, int total, const std::vector<double>& shares, Pipeline& pipeline,
                std::vector<double>& render_s, std::vector<double>& kernel_s);

}  // namespace lumifield
