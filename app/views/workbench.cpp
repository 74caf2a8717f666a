#include "app/views/workbench.h"

#include <algorithm>
#include <system_error>
#include <utility>

#include "app/session/preview_memory.h"
#include "calibration/develop.h"
#include "luminaire/plan.h"
#include "renderer/methods/table_memory.h"

namespace lumifield {

namespace {

QString text(const std::string& utf8) { return QString::fromStdString(utf8); }

/// The longest exposure: what is dark in it is dark in the scan.
double live_exposure_s(const Plan& plan) {
  return plan.exposures_s.empty() ? 0.01 : *std::ranges::max_element(plan.exposures_s);
}

/// One name for one folder, however it was written.
std::filesystem::path whole_path(const std::filesystem::path& path) {
  std::error_code unknown;
  std::filesystem::path whole = std::filesystem::absolute(path, unknown).lexically_normal();
  return whole.has_filename() ? whole : whole.parent_path();
}

}  // namespace

Workbench::Workbench(LivePreview& preview, BenchDevices devices, QObject* parent)
    : QObject(parent), preview_(preview), scan_(std::move(devices)) {
  connect(&model_, &LuminaireModel::resetDone, this, &Workbench::changed);
  connect(&model_, &LuminaireModel::loadBegan, this, &Workbench::take_opened);
  connect(&model_, &LuminaireModel::cellLoaded, this,
          [this](CellIndex cell, std::shared_ptr<const CellImage> image) { preview_.add(cell, std::move(image)); });
  connect(&model_, &LuminaireModel::loadFailed, this, &Workbench::take_refused);
  connect(&model_, &LuminaireModel::loaded, this, [this](const QString&, const QStringList& notes) {
    for (const QString& note : notes) report(OperatorNotice::Level::warning, note);
    go_on();
  });

  // The render thread gets the luminaire and its cells without a detour over this thread.
  connect(
      &scan_, &ScanController::sessionReady, this,
      [this](const LuminaireGeometry& geometry) {
        if (!keep_cells_) preview_.set_luminaire(geometry);
        preview_.set_scan_running(true);
      },
      Qt::DirectConnection);
  connect(
      &scan_, &ScanController::cellReady, this,
      [this](CellIndex cell, std::shared_ptr<const CellImage> image) { preview_.add(cell, std::move(image)); },
      Qt::DirectConnection);

  connect(
      &scan_, &ScanController::passReady, this,
      [this](CellIndex cell, std::shared_ptr<const CellImage> image) { preview_.add(cell, std::move(image), true); },
      Qt::DirectConnection);

  connect(&scan_, &ScanController::started, this, [this](const LuminaireGeometry& geometry, const QString&) {
    folder_ = opening_ = request_->out;
    if (!keep_cells_) model_.reset(geometry, text(request_->out.stem().string()));
    emit changed();
  });
  connect(&scan_, &ScanController::cellStored, this,
          [this](const CellEntry& entry, std::shared_ptr<const CellImage> image) {
            exists_ = true;
            waiting_.erase(entry.cell);
            model_.put(entry, std::move(image));
          });
  connect(&scan_, &ScanController::passStored, this, [this] { exists_ = true; });
  connect(&scan_, &ScanController::progressed, this, [this](const ScanProgress& progress) {
    const bool at_a_cell = progress.state == ScanState::moving || progress.state == ScanState::settling ||
                           progress.state == ScanState::exposing;
    model_.set_measuring(at_a_cell ? progress.cell : std::nullopt);
  });
  connect(&scan_, &ScanController::ended, this, [this](bool, const QString&) {
    preview_.set_scan_running(false);
    model_.set_measuring(std::nullopt);
    waiting_.clear();
    model_.set_waiting({});
    emit changed();
  });
  connect(&scan_, &ScanController::rehearsed, this, [this] {
    model_.set_measuring(std::nullopt);
    emit changed();
  });
  connect(&scan_, &ScanController::noticed, this, &Workbench::noticed);
}

Workbench::~Workbench() = default;

QString Workbench::why_not_start() const {
  if (scan_.activity() == ScanActivity::rehearsing) return tr("A rehearsal runs.");
  if (scan_.busy()) return tr("A scan runs.");
  if (model_.loading() && request_ && opening_ != request_->out) return tr("Another luminaire is being opened.");
  if (!request_) return tr("No bench: choose a bench file and a plan with New scan.");
  if (folder_ == request_->out && model_.geometry() && model_.measured() == model_.total())
    return tr("Every cell is measured. Select cells to take them again, or choose New scan.");
  return {};
}

QString Workbench::why_not_retake() const {
  if (scan_.activity() == ScanActivity::rehearsing) return tr("A rehearsal runs: wait for its end, or stop it.");
  if (scan_.activity() == ScanActivity::stopping) return tr("The scan is stopping: wait for its end.");
  if (scan_.busy() || (request_ && folder_ == request_->out && exists_)) return {};
  return tr(
      "Cells of this luminaire cannot be taken again without its bench: choose New scan with its bench, its plan "
      "and its folder first.");
}

void Workbench::open(const std::filesystem::path& folder) {
  if (scan_.busy()) {
    report(OperatorNotice::Level::warning, tr("%1 is not opened while a scan runs: stop the scan first, or open it in "
                                              "a second window.")
                                               .arg(text(folder.string())));
    return;
  }
  opening_ = whole_path(folder);
  model_.load(opening_);
  emit changed();
}

/// What is asked for is a dataset: now it is the one shown.
void Workbench::take_opened() {
  folder_ = opening_;
  if (request_ && request_->out != folder_) {
    when_loaded_.reset();
    request_.reset();
    scan_.watch(std::nullopt, 0);
  }
  preview_.set_luminaire(*model_.geometry());
  emit changed();
}

/// What was to be opened cannot: all is as before.
void Workbench::take_refused(const QString& message) {
  const bool scans_there = request_ && opening_ == request_->out;
  opening_ = folder_;
  report(OperatorNotice::Level::fault, message);
  if (scans_there && std::exchange(when_loaded_, std::nullopt)) {
    waiting_.clear();
    model_.set_waiting({});
  }
  if (!model_.loading()) go_on();
  emit changed();
}

/// With the scan that waited for a luminaire.
void Workbench::go_on() {
  if (auto retakes = std::exchange(when_loaded_, std::nullopt)) begin(std::move(*retakes));
}

void Workbench::prepare(const std::filesystem::path& bench_file, const std::filesystem::path& plan_file,
                        const std::filesystem::path& out) {
  request_files_.begin([this, bench_file, plan_file, out]() -> std::function<void()> {
    const auto refuse = [this](const Error& error) {
      return [this, message = text(error.message())] { report(OperatorNotice::Level::fault, message); };
    };
    auto bench = read_bench(bench_file);
    if (!bench) return refuse(bench.error());
    auto plan = read_plan(plan_file);
    if (!plan) return refuse(plan.error());
    if (const auto steps = make_scan_plan(*bench, *plan); !steps) return refuse(steps.error());
    // The window keeps every cell's image.
    if (const Status fits = check_preview_memory(luminaire_geometry(*bench, *plan), host_memory_bytes()); !fits)
      return refuse(fits.error());
    ScanRequest request;
    request.bench = std::move(*bench);
    request.plan = std::move(*plan);
    request.out = whole_path(out);
    std::error_code unknown;
    const bool exists = std::filesystem::exists(request.out, unknown);
    if (unknown)
      return refuse({"could not be looked at: " + unknown.message(), request.out.string(), "check its permissions"});
    return [this, request, exists] { take_prepared(request, exists); };
  });
}

void Workbench::take_prepared(ScanRequest request, bool exists) {
  if (scan_.busy()) {
    report(OperatorNotice::Level::warning, tr("A scan runs: stop it before preparing another."));
    return;
  }
  when_loaded_.reset();
  request_ = std::move(request);
  exists_ = exists;
  scan_.watch(request_->bench, live_exposure_s(request_->plan));
  // What was asked for before and is not there yet does not come between.
  model_.give_up_opening();
  opening_ = folder_;
  if (exists_) open(request_->out);
  emit prepared();
  emit changed();
}

void Workbench::show_scene(const std::filesystem::path& file) {
  scene_.begin([this, file]() -> std::function<void()> {
    auto scene = read_scene(file);
    if (!scene)
      return [this, message = text(scene.error().message())] { report(OperatorNotice::Level::fault, message); };
    return [this, file, scene = std::move(*scene)] {
      preview_.set_scene(scene);
      emit sceneRead(scene, text(file.string()));
    };
  });
}

void Workbench::start() {
  if (why_not_start().isEmpty()) begin({});
}

void Workbench::rehearse() {
  if (!why_not_start().isEmpty() || when_loaded_) return;
  RehearsalRequest request;
  request.bench = request_->bench;
  request.plan = request_->plan;
  request.out = request_->out;
  scan_.rehearse(request);
}

void Workbench::begin(std::vector<CellIndex> retakes) {
  if (!request_) return;
  if (model_.loading()) {
    when_loaded_ = std::move(retakes);
    return;
  }
  keep_cells_ = exists_ && folder_ == request_->out && model_.geometry().has_value();
  ScanRequest request = *request_;
  request.resume = exists_;
  request.retake = std::move(retakes);
  scan_.start(request);
  emit changed();
}

void Workbench::retake(const std::vector<CellIndex>& cells) {
  if (cells.empty()) return;
  if (const QString why_not = why_not_retake(); !why_not.isEmpty()) {
    report(OperatorNotice::Level::warning, why_not);
    return;
  }
  if (scan_.busy())
    scan_.retake(cells);
  else
    begin(cells);
  waiting_.insert(cells.begin(), cells.end());
  model_.set_waiting(waiting_);
}

}  // namespace lumifield
