#include "app/session/pipeline.h"

#include <chrono>
#include <cmath>

#include "acquisition/camera.h"
#include "acquisition/stage.h"

namespace lumifield {

namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

/// Hands what the scanner makes to the queues.
class QueueSink : public ScanSink {
 public:
  QueueSink(Pipeline& pipeline, BenchOutcome& outcome) : pipeline_(pipeline), outcome_(outcome) {}

  void cell(RawCell raw) override { pipeline_.raw.push(std::move(raw)); }
  void reference(const ReferenceReading& reading) override {
    outcome_.references.push_back(reading);
    pipeline_.events.push(reading);
  }
  void progress(const ScanProgress& progress) override { pipeline_.events.try_push(progress); }

 private:
  Pipeline& pipeline_;
  BenchOutcome& outcome_;
};

std::string name_of(const CameraInfo& info) {
  return info.vendor + " " + info.model + " " + info.serial + " at " + info.address;
}

Status scan(const Bench& bench, const Plan& plan, const ScanPlan& steps, Pipeline& pipeline, BenchOutcome& outcome) {
  auto camera = open_camera(bench.camera);
  if (!camera) return tl::unexpected(camera.error());
  auto stage = open_stage(bench.stage);
  if (!stage) return tl::unexpected(stage.error());
  outcome.camera = name_of((*camera)->info());
  outcome.stage = (*stage)->info().firmware + " at " + (*stage)->info().path;

  Scanner scanner(**camera, **stage, bench, plan);
  QueueSink sink(pipeline, outcome);
  Status status = scanner.run(steps, sink, pipeline.stop_token());
  outcome.timing = scanner.timing();
  outcome.frames_retaken = (*camera)->frames_retaken();
  return status;
}

}  // namespace

void Pipeline::fail(Error error) {
  {
    std::lock_guard lock(mutex_);
    if (!error_) error_ = std::move(error);
  }
  stop_.request_stop();
}

std::optional<Error> Pipeline::error() const {
  std::lock_guard lock(mutex_);
  return error_;
}

void run_bench(const Bench& bench, const Plan& plan, const ScanPlan& steps, Pipeline& pipeline, BenchOutcome& outcome) {
  Status status = scan(bench, plan, steps, pipeline, outcome);
  if (!status) pipeline.fail(status.error());
  pipeline.raw.close();
}

void run_develop(Developer& developer, Pipeline& pipeline, std::vector<double>& develop_s, int& cells_with_warnings) {
  while (auto raw = pipeline.raw.pop()) {
    const auto start = Clock::now();
    Result<CellImage> image = developer.develop(*raw);
    develop_s.push_back(seconds_since(start));
    if (!image) {
      pipeline.fail(fail_in("cell " + to_string(raw->cell), image.error()).value());
      pipeline.raw.close();
      break;
    }
    if (!image->quality.warnings.empty()) {
      ++cells_with_warnings;
      pipeline.events.try_push(Notice{"cell " + to_string(raw->cell) + ": " + image->quality.warnings.front()});
    }
    if (!pipeline.developed.push({raw->cell, std::move(*image), raw->passes.front().stage_mm})) break;
  }
  pipeline.developed.close();
}

void run_store(DatasetWriter& writer, Pipeline& pipeline, std::vector<double>& store_s, bool& failed) {
  while (auto cell = pipeline.developed.pop()) {
    const auto start = Clock::now();
    Result<CellEntry> entry = writer.add(cell->cell, cell->image, cell->stage_mm);
    store_s.push_back(seconds_since(start));
    if (!entry) {
      failed = true;
      pipeline.fail(entry.error());
      pipeline.developed.close();
      pipeline.raw.close();
      break;
    }
    pipeline.events.push(CellStored{*entry});
    if (!pipeline.stored.push({*entry, std::make_shared<const CellImage>(std::move(cell->image))})) break;
  }
  pipeline.stored.close();
}

void run_render(Renderer* renderer, int already, int total, const std::vector<double>& shares, Pipeline& pipeline,
                std::vector<double>& render_s, std::vector<double>& kernel_s) {
  int cells = already;
  std::size_t next = 0;
  const auto reached = [&] {
    return next < shares.size() && cells >= std::max(1, static_cast<int>(std::lround(shares[next] * total)));
  };
  while (reached()) ++next;

  while (auto cell = pipeline.stored.pop()) {
    if (!renderer) continue;
    const auto start = Clock::now();
    Status added = renderer->add_cell(cell->entry.cell, cell->image);
    render_s.push_back(seconds_since(start));
    kernel_s.push_back(renderer->last_kernel_s());
    ++cells;
    if (added && reached()) {
      Result<Picture> picture = renderer->picture();
      if (picture) {
        pipeline.events.push(PictureMade{shares[next], cells, std::move(*picture)});
        while (reached()) ++next;
        continue;
      }
      added = tl::unexpected(picture.error());
    }
    // The scan outlives its preview: what is measured matters more than what is shown.
    if (!added) {
      pipeline.events.push(Notice{"the preview ends: " + added.error().message()});
      renderer = nullptr;
    }
  }
}

}  // namespace lumifield
