#include "app/session/pipeline.h"

#include <chrono>
#include <cmath>
#include <set>
#include <utility>

#include "acquisition/camera.h"
#include "acquisition/scan/bench_clock.h"
#include "acquisition/stage.h"
#include "app/session/device_names.h"
#include "app/session/guarded.h"
#include "app/session/instruments.h"
#include "app/session/scan_recording.h"

namespace lumifield {

namespace {

using Clock = std::chrono::steady_clock;

constexpr double room_poll_s = 0.5;  ///< a full disk is asked again

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

/// Hands what the scanner makes to the queues.
class QueueSink : public ScanSink {
 public:
  QueueSink(Pipeline& pipeline, BenchOutcome& outcome, BenchView* view)
      : pipeline_(pipeline), outcome_(outcome), view_(view) {}

  void cell(RawCell raw) override { pipeline_.raw.push(std::move(raw)); }
  void reference(const ReferenceReading& reading) override {
    outcome_.references.push_back(reading);
    pipeline_.tell_reading(reading);
    pipeline_.events.push(reading);
  }
  void notice(const std::string& text) override { pipeline_.events.push(Notice{text}); }
  void progress(const ScanProgress& progress) override {
    // Said once, and somebody waits for them.
    const bool must_arrive = is_final(progress.state) || progress.state == ScanState::paused;
    must_arrive ? pipeline_.events.push(progress) : pipeline_.events.try_push(progress);
  }
  void seen(const Bracket& bracket, const std::string& place, const Vec2& stage_mm) override {
    if (view_) view_->show(bracket, place, stage_mm);
  }

 private:
  Pipeline& pipeline_;
  BenchOutcome& outcome_;
  BenchView* view_;
};

Status scan(const ScanRequest& request, const ScanPlan& steps, const std::map<int, ReferenceReading>& first,
            Pipeline& pipeline, BenchOutcome& outcome) {
  BenchView unseen;
  BenchView& view = request.bench_view ? *request.bench_view : unseen;
  Instruments instruments(request.bench, request.devices, view);
  if (Status opened = instruments.open(); !opened) return opened;
  outcome.camera = name_of(instruments.camera().info());
  outcome.stage = name_of(instruments.stage().info());
  const Bench bench = at_the_pace_of(instruments.camera(), request.plan, request.bench);
  outcome.prediction = predict(bench, request.plan, steps, instruments.stage().info(), request.out,
                               request.recording ? request.recording->folder() : std::filesystem::path());
  if (request.recording) request.recording->tell([&] { pipeline.events.push(end_of_recording(*request.recording)); });
  pipeline.events.push(*outcome.prediction);

  Scanner scanner(instruments.camera(), instruments.stage(), bench, request.plan);
  for (const auto& [pass, reading] : first) scanner.refer_to(reading);
  if (request.accept_drift) scanner.accept_drift();
  scanner.obey(pipeline.control);
  scanner.recover_with(instruments);
  QueueSink sink(pipeline, outcome, request.bench_view.get());
  Status status = scanner.run(steps, sink, pipeline.stop_token(), pipeline.abandon_token());
  outcome.timing = scanner.timing();
  outcome.cameras_lost = scanner.cameras_lost();
  outcome.frames_retaken = instruments.frames_retaken();
  return status;
}

std::string joined(const std::vector<std::string>& texts) {
  std::string text;
  for (const std::string& part : texts) text.append(text.empty() ? "" : "; ").append(part);
  return text;
}

/// Does again what the disk is too full for, until there is room or the scan is stopped. Nothing is lost meanwhile: the
/// queues fill up, and then the bench waits.
template <class Write>
auto once_there_is_room(Pipeline& pipeline, const Write& write) {
  auto done = write();
  const auto full = [&] { return !done && done.error().kind == ErrorKind::disk_full; };
  if (!full()) return done;
  pipeline.events.push(Notice{done.error().what + " (" + done.error().where +
                              "): storing waits and goes on by itself once there is room; what is measured is kept"});
  while (full()) {
    if (!steady_bench_clock().wait(room_poll_s, pipeline.stop_token())) {
      done.error().what = "stopped by the operator while the disk was full; cells that were measured are not stored";
      done.error().kind = ErrorKind::stopped;
      return done;
    }
    done = write();
  }
  if (done) pipeline.events.push(Notice{"there is room on the disk again: storing goes on"});
  return done;
}

/// Shows what one pass alone makes, of a cell that is not whole.
Status show_half(PassByPass& passes, const RawCell& raw, Pipeline& pipeline) {
  const std::string name = raw.passes.front().name, place = "cell " + to_string(raw.cell) + ", pass " + name;
  Result<std::optional<CellImage>> image = passes.alone(raw);
  if (!image) return tl::unexpected(image.error());
  PassStored stored{raw.cell, name, nullptr};
  if (*image) {
    if (!(*image)->quality.warnings.empty())
      pipeline.events.push(Notice{place + ": " + joined((*image)->quality.warnings)});
    (*image)->variance = std::vector<float>();
    stored.image = std::make_shared<const CellImage>(std::move(**image));
    pipeline.stored.push({raw.cell, stored.image, true});
  }
  pipeline.events.push(std::move(stored));
  return {};
}

Status show_stored_halves(PassByPass& passes, Pipeline& pipeline) {
  for (const CellIndex cell : passes.to_show()) {
    if (pipeline.stop_token().stop_requested()) break;
    const Result<RawCell> raw = passes.half(cell, 0);
    if (!raw) return tl::unexpected(raw.error());
    if (Status shown = show_half(passes, *raw, pipeline); !shown) return shown;
  }
  return {};
}

/// Stores a pass, then shows it.
Status keep_half(HalfWay& half_way, const RawCell& raw, Pipeline& pipeline) {
  Status kept;
  if (half_way.passes.begins(raw)) kept = once_there_is_room(pipeline, half_way.record);
  if (kept) kept = once_there_is_room(pipeline, [&] { return half_way.passes.keep(raw); });
  half_way.failed = !kept;
  return kept ? show_half(half_way.passes, raw, pipeline) : kept;
}

Status develop(Developer& developer, Pipeline& pipeline, std::vector<double>& develop_s, int& cells_with_warnings,
               int& cells_adapted, HalfWay* half_way) {
  if (half_way && half_way->shows)
    if (Status shown = show_stored_halves(half_way->passes, pipeline); !shown) return shown;
  while (auto raw = pipeline.raw.pop()) {
    const std::string place = "cell " + to_string(raw->cell);
    if (raw->passes.empty()) return fail("has no passes", place, "scan it again with --resume");
    if (half_way && !half_way->passes.is_last(*raw)) {
      if (Status kept = keep_half(*half_way, *raw, pipeline); !kept) return kept;
      continue;
    }
    if (half_way) {
      Result<RawCell> whole = half_way->passes.whole(std::move(*raw));
      if (!whole) return tl::unexpected(whole.error());
      *raw = std::move(*whole);
    }
    const auto start = Clock::now();
    Result<CellImage> image = developer.develop(*raw);
    develop_s.push_back(seconds_since(start));
    if (!image) return tl::unexpected(image.error());
    if (!image->quality.exposures_s.empty()) ++cells_adapted;
    if (!image->quality.warnings.empty()) {
      ++cells_with_warnings;
      pipeline.events.push(Notice{place + ": " + joined(image->quality.warnings)});
    }
    if (!pipeline.developed.push({raw->cell, std::move(*image), raw->passes.front().stage_mm})) break;
  }
  return {};
}

Status store(DatasetWriter& writer, const std::vector<std::string>& notes, const std::function<Status()>& record,
             Pipeline& pipeline, std::vector<double>& store_s) {
  for (const std::string& note : notes) pipeline.events.push(Notice{note});
  for (bool first = true; auto cell = pipeline.developed.pop(); first = false) {
    if (first)
      if (Status recorded = once_there_is_room(pipeline, record); !recorded) return recorded;
    const auto start = Clock::now();
    Result<CellEntry> entry =
        once_there_is_room(pipeline, [&] { return writer.add(cell->cell, cell->image, cell->stage_mm); });
    store_s.push_back(seconds_since(start));
    if (!entry) return tl::unexpected(entry.error());
    cell->image.variance = std::vector<float>();
    const auto image = std::make_shared<const CellImage>(std::move(cell->image));
    pipeline.events.push(CellStored{*entry, image});
    if (!pipeline.stored.push({entry->cell, image})) break;
  }
  return {};
}

/// The preview as far as it has come.
struct Preview {
  Renderer* renderer;
  int cells, total;
  const std::vector<double>& shares;
  std::size_t next = 0;
  std::set<CellIndex> half_cells = {};

  bool reached() const {
    return next < shares.size() && cells >= std::max(1, static_cast<int>(std::lround(shares[next] * total)));
  }
  void skip_reached() {
    while (reached()) ++next;
  }
};

Status show(Preview& preview, const StoredCell& cell, Pipeline& pipeline, std::vector<double>& render_s,
            std::vector<double>& kernel_s) {
  const auto start = Clock::now();
  const Status added = preview.renderer->add_cell(cell.cell, cell.image);
  render_s.push_back(seconds_since(start));
  kernel_s.push_back(preview.renderer->last_kernel_s());
  // A half cell that is there already counts once.
  if (!(cell.half ? !preview.half_cells.insert(cell.cell).second : preview.half_cells.erase(cell.cell) > 0))
    ++preview.cells;
  if (!added || !preview.reached()) return added;
  Result<Picture> picture = preview.renderer->picture();
  if (!picture) return tl::unexpected(picture.error());
  if (!preview.half_cells.empty())
    picture->note += (picture->note.empty() ? "" : "; ") + std::to_string(preview.half_cells.size()) +
                     " cells with the first pass alone";
  pipeline.events.push(PictureMade{preview.shares[preview.next], preview.cells,
                                   static_cast<int>(preview.half_cells.size()), std::move(*picture)});
  preview.skip_reached();
  return {};
}

}  // namespace

void Pipeline::fail(Error error) {
  bool first = false;
  {
    std::lock_guard lock(mutex_);
    first = !error_;
    if (first) error_ = std::move(error);
  }
  abandon_.request_stop();
  if (!first && (error.kind == ErrorKind::fault || error.kind == ErrorKind::refused))
    events.push(Notice{error.message()});
}

std::optional<Error> Pipeline::error() const {
  std::lock_guard lock(mutex_);
  return error_;
}

void Pipeline::tell_reading(const ReferenceReading& reading) {
  std::lock_guard lock(mutex_);
  first_readings_.try_emplace(reading.pass, reading);
}

std::optional<ReferenceReading> Pipeline::first_reading(int pass) const {
  std::lock_guard lock(mutex_);
  const auto found = first_readings_.find(pass);
  return found == first_readings_.end() ? std::nullopt : std::optional(found->second);
}

void run_bench(const ScanRequest& request, const ScanPlan& steps, const std::map<int, ReferenceReading>& first,
               Pipeline& pipeline, BenchOutcome& outcome) {
  Status status = guarded("bench", [&] { return scan(request, steps, first, pipeline, outcome); });
  if (!status) pipeline.fail(std::move(status).error());
  pipeline.raw.close();
}

void run_develop(Developer& developer, Pipeline& pipeline, std::vector<double>& develop_s, int& cells_with_warnings,
                 int& cells_adapted, HalfWay* half_way) {
  Status status = guarded(
      "develop", [&] { return develop(developer, pipeline, develop_s, cells_with_warnings, cells_adapted, half_way); });
  if (!status) pipeline.fail(std::move(status).error());
  pipeline.raw.close();
  pipeline.developed.close();
}

void run_store(DatasetWriter& writer, const std::vector<std::string>& notes, const std::function<Status()>& record,
               Pipeline& pipeline, std::vector<double>& store_s, bool& failed) {
  Status status = guarded("store", [&] { return store(writer, notes, record, pipeline, store_s); });
  failed = !status;
  if (!status) pipeline.fail(std::move(status).error());
  pipeline.developed.close();
  pipeline.stored.close();
}

void run_render(Renderer* renderer, int already, int total, const std::vector<double>& shares, Pipeline& pipeline,
                std::vector<double>& render_s, std::vector<double>& kernel_s) {
  Preview preview{renderer, already, total, shares};
  preview.skip_reached();
  while (auto cell = pipeline.stored.pop()) {
    if (!preview.renderer) continue;
    const Status shown = guarded("preview", [&] { return show(preview, *cell, pipeline, render_s, kernel_s); });
    // The scan outlives its preview: what is measured matters more than what is shown.
    if (!shown) {
      pipeline.events.push(Notice{"the preview ends: " + shown.error().message()});
      preview.renderer = nullptr;
    }
  }
  pipeline.stored.close();
}

}  // namespace lumifield
