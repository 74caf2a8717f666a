#include "app/session/scan_session.h"

#include <future>
#include <set>
#include <sys/resource.h>
#include <system_error>
#include <thread>

#include "app/session/pipeline.h"
#include "app/session/provenance.h"

namespace lumifield {

namespace {

/// Lower than the threads that keep the bench busy.
constexpr int render_niceness = 10;

}  // namespace

struct ScanSession::Impl {
  Impl(ScanRequest r, ScanPlan s, Developer d) : request(std::move(r)), steps(std::move(s)), developer(std::move(d)) {}

  Status open_dataset();
  Status start_renderer();
  void render_thread(std::promise<Status> ready);
  void run();
  Status close_dataset();

  ScanRequest request;
  ScanPlan steps;
  Developer developer;
  std::string started_utc = utc_now();
  std::optional<DatasetWriter> writer;
  std::set<CellIndex> done;
  Pipeline pipeline;
  BenchOutcome bench;
  ScanSummary summary;
  bool store_failed = false;
  std::thread bench_thread, develop_thread, store_thread, render_thread_;
};

Status ScanSession::Impl::open_dataset() {
  Manifest manifest;
  manifest.geometry = developer.geometry();
  manifest.name = request.name.empty() ? request.out.stem().string() : request.name;
  Result<DatasetWriter> opened = request.resume && std::filesystem::exists(request.out)
                                     ? DatasetWriter::resume(request.out, manifest.geometry)
                                     : (manifest.provenance_json = provenance_json("{}", request, summary, started_utc),
                                        DatasetWriter::create(request.out, manifest));
  if (!opened) return tl::unexpected(opened.error());
  writer.emplace(std::move(*opened));
  for (const CellEntry& entry : writer->manifest().cells) done.insert(entry.cell);

  Result<ScanPlan> left = make_scan_plan(request.bench, request.plan, done);
  if (!left) return tl::unexpected(left.error());
  steps = std::move(*left);
  return {};
}

void ScanSession::Impl::render_thread(std::promise<Status> ready) {
  if (!request.preview) {
    ready.set_value({});
    return run_render(nullptr, 0, 0, {}, pipeline, summary.times.render_s, summary.times.kernel_s);
  }
  // Linux keeps niceness per thread; those that OpenCL starts from here inherit it.
  setpriority(PRIO_PROCESS, 0, render_niceness);
  auto renderer = Renderer::create(*request.preview, request.preview_width_px, request.preview_height_px);
  Status status = renderer ? (*renderer)->set_luminaire(developer.geometry()) : tl::unexpected(renderer.error());
  for (const CellEntry& entry : writer->manifest().cells) {
    if (!status) break;
    auto image = read_cell({request.out, writer->manifest(), {}}, entry);
    status = image ? (*renderer)->add_cell(entry.cell, std::make_shared<const CellImage>(std::move(*image)))
                   : tl::unexpected(image.error());
  }
  if (status) {
    summary.opengl = (*renderer)->info().opengl;
    summary.opencl = (*renderer)->info().opencl;
  }
  const bool usable = status.has_value();
  const int already = static_cast<int>(done.size());
  ready.set_value(std::move(status));
  if (usable)
    run_render(renderer->get(), already, developer.geometry().sampling.cells(), request.picture_shares, pipeline,
               summary.times.render_s, summary.times.kernel_s);
}

Status ScanSession::Impl::start_renderer() {
  std::promise<Status> ready;
  std::future<Status> started = ready.get_future();
  render_thread_ = std::thread([this, promise = std::move(ready)]() mutable { render_thread(std::move(promise)); });
  return started.get();
}

void ScanSession::Impl::run() {
  store_thread = std::thread([this] { run_store(*writer, pipeline, summary.times.store_s, store_failed); });
  develop_thread =
      std::thread([this] { run_develop(developer, pipeline, summary.times.develop_s, summary.cells_with_warnings); });
  bench_thread = std::thread([this] {
    run_bench(request.bench, request.plan, steps, pipeline, bench);
    // The stages behind end one after the other once their input has.
    develop_thread.join();
    store_thread.join();
    render_thread_.join();
    pipeline.events.close();
  });
}

/// Nothing half-written: a scan that failed before its first cell leaves no folder behind.
Status ScanSession::Impl::close_dataset() {
  if (!writer) return {};
  if (writer->manifest().cells.empty()) {
    std::error_code error;
    std::filesystem::remove_all(request.out, error);
    if (error) return fail("could not remove the empty dataset: " + error.message(), request.out.string());
    return {};
  }
  if (store_failed) return {};
  writer->set_provenance(provenance_json(writer->manifest().provenance_json, request, summary, started_utc));
  return writer->close();
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
  Result<ScanPlan> steps = make_scan_plan(request.bench, request.plan);
  if (!steps) return tl::unexpected(steps.error());
  Result<Developer> developer = Developer::create(request.bench, request.plan);
  if (!developer) return tl::unexpected(developer.error());

  auto impl = std::make_unique<Impl>(std::move(request), std::move(*steps), std::move(*developer));
  if (Status opened = impl->open_dataset(); !opened) return tl::unexpected(opened.error());
  if (Status rendered = impl->start_renderer(); !rendered) {
    impl->render_thread_.join();
    if (Status closed = impl->close_dataset(); !closed) return tl::unexpected(closed.error());
    return tl::unexpected(rendered.error());
  }
  impl->run();
  return std::unique_ptr<ScanSession>(new ScanSession(std::move(impl)));
}

std::optional<SessionEvent> ScanSession::next_event() { return impl_->pipeline.events.pop(); }

void ScanSession::stop() { impl_->pipeline.request_stop(); }

Result<ScanSummary> ScanSession::wait() {
  impl_->bench_thread.join();
  ScanSummary& summary = impl_->summary;
  summary.dataset = impl_->request.out;
  summary.timing = impl_->bench.timing;
  summary.references = impl_->bench.references;
  summary.camera = impl_->bench.camera;
  summary.stage = impl_->bench.stage;
  summary.frames_retaken = impl_->bench.frames_retaken;

  const Status closed = impl_->close_dataset();
  if (std::optional<Error> error = impl_->pipeline.error()) {
    if (!closed) error->what += " (and then: " + closed.error().message() + ")";
    return tl::unexpected(std::move(*error));
  }
  if (!closed) return tl::unexpected(closed.error());

  std::set<CellIndex> stored;
  for (const CellEntry& entry : impl_->writer->manifest().cells) stored.insert(entry.cell);
  const Sampling& sampling = impl_->developer.geometry().sampling;
  summary.coverage.total = sampling.cells();
  summary.coverage.measured = static_cast<int>(stored.size());
  for (int k = 0; k < sampling.cells(); ++k)
    if (!stored.contains(sampling.index(k))) summary.coverage.missing.push_back(sampling.index(k));
  return summary;
}

}  // namespace lumifield
