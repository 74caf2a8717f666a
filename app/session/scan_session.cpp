#include "app/session/scan_session.h"

#include <filesystem>
#include <future>
#include <set>
#include <sys/resource.h>
#include <system_error>
#include <thread>

#include "app/session/dataset_folder.h"
#include "app/session/guarded.h"
#include "app/session/pipeline.h"
#include "app/session/precedent.h"
#include "app/session/preview_memory.h"
#include "app/session/provenance.h"
#include "renderer/methods/table_memory.h"

namespace lumifield {

namespace {

/// Lower than the threads that keep the bench busy.
constexpr int render_niceness = 10;

}  // namespace

struct ScanSession::Impl {
  Impl(ScanRequest r, ScanPlan s, Developer d) : request(std::move(r)), steps(std::move(s)), developer(std::move(d)) {}

  /// Ends the threads of a start that was refused.
  ~Impl();

  Status begin();
  Status open_dataset();
  Status create_dataset();
  Status resume_dataset();
  Status open_passes(PassCells& taken);
  Status record_first_readings();
  Status start_renderer();
  Status prepare_renderer(std::unique_ptr<Renderer>& renderer);
  void render_thread(std::promise<Status> ready);
  void run();
  ScanKept kept() const;
  Status discard_dataset();
  Status close_dataset();
  Status close_writer();
  Result<ScanSummary> finish();

  ScanRequest request;
  ScanPlan steps;
  Developer developer;
  std::string started_utc = utc_now();
  std::optional<DatasetWriter> writer;
  bool created = false;                   ///< by this run, not resumed
  std::string earlier = "{}";             ///< the provenance before this run
  std::vector<std::string> notes;         ///< for the operator, at the start
  std::map<int, ReferenceReading> first;  ///< of earlier scans, by pass
  std::set<CellIndex> done;
  std::optional<PassByPass> passes;  ///< where the operator changes the slide
  std::optional<HalfWay> half_way;
  Pipeline pipeline;
  BenchOutcome bench;
  ScanSummary summary;
  bool store_failed = false;
  std::thread bench_thread, develop_thread, store_thread, render_thread_;
};

ScanSession::Impl::~Impl() {
  pipeline.raw.close();
  pipeline.developed.close();
  pipeline.stored.close();
  pipeline.events.close();
  for (std::thread* thread : {&bench_thread, &develop_thread, &store_thread, &render_thread_})
    if (thread->joinable()) thread->join();
}

Status ScanSession::Impl::open_dataset() {
  created = !request.resume;
  std::error_code code;
  const bool is_there = std::filesystem::exists(request.out, code);
  if (code) return fail("could not be looked at: " + code.message(), request.out.string(), "check its permissions");
  if (request.resume && !is_there)
    return fail("there is no dataset to go on with", request.out.string(),
                "check the path, or leave out --resume to begin a new one");
  if (Status opened = created ? create_dataset() : resume_dataset(); !opened) return opened;
  for (const CellEntry& entry : writer->manifest().cells) done.insert(entry.cell);
  PassCells taken;
  if (request.bench.filter.change == PassChange::by_operator)
    if (Status opened = open_passes(taken); !opened) return opened;
  for (const CellIndex cell : request.retake) {
    done.erase(cell);
    for (std::set<CellIndex>& cells : taken) cells.erase(cell);
  }
  Result<ScanPlan> left = make_scan_plan(request.bench, request.plan, done, taken);
  if (!left) return tl::unexpected(left.error());
  steps = std::move(*left);
  if (steps.steps.empty()) {
    request.preview.reset();
    notes.push_back("all " + std::to_string(steps.cells_before) + " cells are there: nothing is left to measure");
  }
  return {};
}

Status ScanSession::Impl::open_passes(PassCells& taken) {
  Result<PassByPass> opened = PassByPass::open(request.bench, request.plan, request.out, writer->manifest());
  if (!opened) return tl::unexpected(opened.error());
  passes.emplace(std::move(*opened));
  for (std::string& note : passes->notes()) notes.push_back(std::move(note));
  taken = passes->taken();
  for (const std::set<CellIndex>& cells : taken)
    for (const CellIndex cell : cells) done.erase(cell);  // it is being taken again
  // Pictures at shares of the cells wait for those of this scan.
  half_way.emplace(HalfWay{*passes, [this] { return record_first_readings(); }, request.attended});
  return {};
}

Status ScanSession::Impl::create_dataset() {
  Manifest manifest;
  manifest.geometry = developer.geometry();
  manifest.name = request.name.empty() ? request.out.stem().string() : request.name;
  manifest.provenance_json = provenance_json(earlier, request, started_utc, {}, nullptr);
  Result<DatasetWriter> opened = DatasetWriter::create(request.out, std::move(manifest));
  if (!opened) return tl::unexpected(opened.error());
  writer.emplace(std::move(*opened));
  return {};
}

/// Compares before the writer cleans up: a dataset that is refused stays as it is.
Status ScanSession::Impl::resume_dataset() {
  const Result<DatasetIndex> index = read_dataset_index(request.out);
  if (!index) return tl::unexpected(index.error());
  earlier = index->manifest.provenance_json;
  Result<std::string> note = check_same_measurement(earlier, request.bench, request.plan);
  if (!note) return fail_in(request.out.string(), note.error());
  if (!note->empty()) notes.push_back(std::move(*note));

  Result<DatasetWriter> opened = DatasetWriter::resume(request.out, developer.geometry());
  if (!opened) return tl::unexpected(opened.error());
  writer.emplace(std::move(*opened));
  notes.insert(notes.end(), writer->notes().begin(), writer->notes().end());
  for (int pass = 0; pass < static_cast<int>(request.bench.filter.passes.size()); ++pass)
    if (const auto reading = first_reading(earlier, pass)) first[pass] = *reading;
  if (first.empty() && !writer->manifest().cells.empty())
    notes.push_back("the dataset's first reading of the reference cell is not on record: its drift begins anew");
  return {};
}

/// The drift of every cell refers to the dataset's first reading through its pass, so it is on disk before the first of
/// them: a scan that is killed can be gone on with. On the store thread; before half cells on the develop thread, while
/// the store thread still waits for its first cell.
Status ScanSession::Impl::record_first_readings() {
  std::vector<ReferenceReading> readings;
  for (int pass = 0; pass < static_cast<int>(request.bench.filter.passes.size()); ++pass)
    if (const auto reading = pipeline.first_reading(pass); reading && !first.contains(pass))
      readings.push_back(*reading);
  if (readings.empty()) return {};
  return writer->record_provenance(provenance_json(earlier, request, started_utc, readings, nullptr));
}

/// Makes the renderer and gives it the cells that are stored.
Status ScanSession::Impl::prepare_renderer(std::unique_ptr<Renderer>& renderer) {
  auto made = Renderer::create(*request.preview, request.preview_width_px, request.preview_height_px);
  if (!made) return tl::unexpected(made.error());
  renderer = std::move(*made);
  if (Status set = renderer->set_luminaire(developer.geometry()); !set) return set;
  const DatasetIndex index{request.out, writer->manifest(), {}};
  for (const CellEntry& entry : index.manifest.cells) {
    Result<CellImage> image = read_cell(index, entry);
    if (!image) return tl::unexpected(image.error());
    image->variance = std::vector<float>();
    if (Status added = renderer->add_cell(entry.cell, std::make_shared<const CellImage>(std::move(*image))); !added)
      return added;
  }
  const RendererInfo info = renderer->info();
  summary.opengl = info.opengl;
  summary.opencl = info.opencl;
  for (const std::string& note : info.notes) notes.push_back("preview: " + note);
  notes.push_back("preview: left out: " + info.left_out);
  return {};
}

void ScanSession::Impl::render_thread(std::promise<Status> ready) {
  std::unique_ptr<Renderer> renderer;
  // Linux keeps niceness per thread; those that OpenCL starts from here inherit it.
  if (request.preview) setpriority(PRIO_PROCESS, 0, render_niceness);
  Status prepared = guarded("preview", [&] { return request.preview ? prepare_renderer(renderer) : Status{}; });
  const bool usable = prepared.has_value();
  ready.set_value(std::move(prepared));
  if (usable)
    run_render(renderer.get(), static_cast<int>(done.size()), developer.geometry().sampling.cells(),
               request.picture_shares, pipeline, summary.times.render_s, summary.times.kernel_s);
}

Status ScanSession::Impl::start_renderer() {
  std::promise<Status> ready;
  std::future<Status> started = ready.get_future();
  render_thread_ = std::thread([this, promise = std::move(ready)]() mutable { render_thread(std::move(promise)); });
  return started.get();
}

void ScanSession::Impl::run() {
  store_thread = std::thread([this] {
    const auto record = [this] { return record_first_readings(); };
    run_store(*writer, notes, record, pipeline, summary.times.store_s, store_failed);
  });
  develop_thread = std::thread([this] {
    run_develop(developer, pipeline, summary.times.develop_s, summary.cells_with_warnings, summary.cells_adapted,
                half_way ? &*half_way : nullptr);
  });
  bench_thread = std::thread([this] {
    if (steps.steps.empty())
      pipeline.raw.close();
    else
      run_bench(request, steps, first, pipeline, bench);
    // The stages behind end one after the other once their input has.
    develop_thread.join();
    store_thread.join();
    render_thread_.join();
    pipeline.events.close();
  });
}

/// Everything that may refuse; what it leaves behind is undone by `discard_dataset`.
Status ScanSession::Impl::begin() {
  if (request.attended) pipeline.control.attend();
  if (request.preview)
    if (Status fits = check_preview_memory(developer.geometry(), host_memory_bytes()); !fits) return fits;
  if (Status opened = open_dataset(); !opened) return opened;
  if (Status rendered = start_renderer(); !rendered) return rendered;
  run();
  return {};
}

ScanKept ScanSession::Impl::kept() const {
  return {.cells = static_cast<int>(writer->manifest().cells.size()),
          .total = developer.geometry().sampling.cells(),
          .half_cells = passes ? static_cast<int>(passes->size()) : 0};
}

/// Nothing half-written: a scan that stored no cell leaves no folder behind that it made, and none changed.
Status ScanSession::Impl::discard_dataset() {
  if (!writer || !created || kept().cells + kept().half_cells > 0) return {};
  if (passes)
    if (Status ok = passes->remove_stale(writer->manifest()); !ok) return ok;  // a dark set whose half cell failed
  return remove_empty_dataset(request.out);
}

Status ScanSession::Impl::close_dataset() {
  if (!writer || store_failed || (half_way && half_way->failed)) return discard_dataset();
  if (!summary.times.store_s.empty() || (passes && passes->kept_any())) {
    // The cells are worth more than the record of their making.
    const auto record = guarded("provenance", [&]() -> Result<std::string> {
      return provenance_json(earlier, request, started_utc, summary.references, &summary);
    });
    if (record) writer->set_provenance(*record);
    const Status closed = close_writer();
    return closed && !record ? tl::unexpected(record.error()) : closed;
  }
  if (pipeline.error()) return discard_dataset();
  return writer->is_closed() ? Status{} : close_writer();
}

/// Half cells go once the cells that they are part of are in the manifest.
Status ScanSession::Impl::close_writer() {
  Status closed = writer->close();
  return closed && passes ? passes->remove_stale(writer->manifest()) : closed;
}

ScanSession::ScanSession(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}

ScanSession::~ScanSession() {
  if (!impl_ || !impl_->bench_thread.joinable()) return;
  stop();
  while (next_event()) {
  }
  (void)wait();
}

Result<std::unique_ptr<ScanSession>> ScanSession::start(ScanRequest request) {
  return guarded("scan", [&]() -> Result<std::unique_ptr<ScanSession>> {
    Result<ScanPlan> steps = make_scan_plan(request.bench, request.plan);
    if (!steps) return tl::unexpected(steps.error());
    Result<Developer> developer = Developer::create(request.bench, request.plan);
    if (!developer) return tl::unexpected(developer.error());
    auto impl = std::make_unique<Impl>(std::move(request), std::move(*steps), std::move(*developer));
    auto session = std::unique_ptr<ScanSession>(new ScanSession(nullptr));
    Status begun = guarded("scan", [&] { return impl->begin(); });
    if (!begun) {
      if (Status gone = impl->discard_dataset(); !gone)
        begun.error().what += " (and then: " + gone.error().message() + ")";
      return tl::unexpected(begun.error());
    }
    session->impl_ = std::move(impl);
    return session;
  });
}

const LuminaireGeometry& ScanSession::geometry() const { return impl_->developer.geometry(); }

std::optional<SessionEvent> ScanSession::next_event() { return impl_->pipeline.events.pop(); }

void ScanSession::stop() { impl_->pipeline.request_stop(); }

void ScanSession::pause() { impl_->pipeline.control.pause(); }

void ScanSession::resume() { impl_->pipeline.control.resume(); }

void ScanSession::retake(std::span<const CellIndex> cells) { impl_->pipeline.control.retake(cells); }

Result<ScanSummary> ScanSession::wait() {
  impl_->bench_thread.join();
  return guarded("scan", [&] { return impl_->finish(); });
}

ScanKept ScanSession::kept() const { return impl_->kept(); }

Result<ScanSummary> ScanSession::Impl::finish() {
  summary.dataset = request.out;
  summary.timing = bench.timing;
  summary.prediction = bench.prediction;
  summary.references = bench.references;
  summary.camera = bench.camera;
  summary.stage = bench.stage;
  summary.frames_retaken = bench.frames_retaken;
  summary.cameras_lost = bench.cameras_lost;

  const Status closed = close_dataset();
  if (std::optional<Error> error = pipeline.error()) {
    if (error->kind == ErrorKind::stopped && created && kept().cells + kept().half_cells == 0)
      error->remedy = "no cell was stored yet: run again to begin anew";
    if (!closed) error->what += " (and then: " + closed.error().message() + ")";
    return tl::unexpected(std::move(*error));
  }
  if (!closed) return tl::unexpected(closed.error());

  std::set<CellIndex> stored;
  for (const CellEntry& entry : writer->manifest().cells) stored.insert(entry.cell);
  const Sampling& sampling = developer.geometry().sampling;
  summary.cells_before = static_cast<int>(done.size());
  summary.coverage.total = sampling.cells();
  summary.coverage.measured = static_cast<int>(stored.size());
  for (int k = 0; k < sampling.cells(); ++k)
    if (!stored.contains(sampling.index(k))) summary.coverage.missing.push_back(sampling.index(k));
  return summary;
}

}  // namespace lumifield
