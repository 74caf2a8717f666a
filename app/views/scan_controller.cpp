#include "app/views/scan_controller.h"

#include <utility>

#include "app/views/scan_words.h"

namespace lumifield {

namespace {

QString text(const std::string& utf8) { return QString::fromStdString(utf8); }

/// Calls a member of the session when there is one.
template <class Call>
void with(std::mutex& mutex, const std::unique_ptr<ScanSession>& session, Call call) {
  std::lock_guard lock(mutex);
  if (session) call(*session);
}

}  // namespace

ScanController::ScanController(BenchDevices devices, QObject* parent) : QObject(parent), devices_(std::move(devices)) {
  qRegisterMetaType<ScanProgress>();
  qRegisterMetaType<OperatorNotice>();
}

ScanController::~ScanController() {
  watch_.reset();
  stop();
  if (thread_.joinable()) thread_.join();
}

void ScanController::set_activity(ScanActivity activity) {
  if (activity_ == activity) return;
  activity_ = activity;
  emit activityChanged(activity);
}

void ScanController::watch(const std::optional<Bench>& bench, double exposure_s) {
  watched_ = bench;
  watch_exposure_s_ = exposure_s;
  if (!busy()) rest();
}

/// Watches the bench until the next scan. A watch that ends may wait for its camera: not on this thread.
void ScanController::rest() {
  watch_ = std::make_unique<BenchWatch>(watched_, watch_exposure_s_, bench_view_, std::move(watch_), devices_);
}

void ScanController::start(const ScanRequest& request) {
  if (busy()) return;
  set_activity(ScanActivity::starting);
  stop_early_ = false;
  retake_early_.clear();
  progress_ = {};
  if (thread_.joinable()) thread_.join();  // it has ended
  ScanRequest mine = request;
  mine.bench_view = bench_view_;
  mine.devices = devices_;
  mine.attended = true;
  thread_ =
      std::jthread([this, mine = std::move(mine), old = std::shared_ptr<BenchWatch>(std::move(watch_))]() mutable {
        old.reset();  // the devices are free
        run(std::move(mine));
      });
}

void ScanController::rehearse(const RehearsalRequest& request) {
  if (busy()) return;
  set_activity(ScanActivity::rehearsing);
  rehearsal_stop_ = {};
  if (thread_.joinable()) thread_.join();  // it has ended
  RehearsalRequest mine = request;
  mine.bench_view = bench_view_;
  mine.devices = devices_;
  thread_ = std::jthread([this, mine = std::move(mine), stop = rehearsal_stop_.get_token(),
                          old = std::shared_ptr<BenchWatch>(std::move(watch_))]() mutable {
    old.reset();  // the devices are free
    auto told = lumifield::rehearse(mine, stop, [this](const ScanProgress& progress) {
      QMetaObject::invokeMethod(this, [this, progress] {
        if (activity_ == ScanActivity::rehearsing) emit progressed(progress);
      });
    });
    QMetaObject::invokeMethod(this, [this, told = std::move(told)] { finish_rehearsal(told); });
  });
}

void ScanController::finish_rehearsal(const Result<Rehearsal>& told) {
  if (thread_.joinable()) thread_.join();  // it has nothing left to do
  set_activity(ScanActivity::idle);
  rest();
  using enum OperatorNotice::Level;
  if (told) {
    const bool good = told->scan.has_room() && told->quality.warnings.empty();
    emit noticed({good ? information : warning, rehearsal_text(*told)});
    emit rehearsed(good ? tr("Rehearsed: see Notices.") : tr("Rehearsed, with warnings: see Notices."));
  } else if (told.error().kind == ErrorKind::stopped) {
    emit noticed({information, tr("The rehearsal was stopped; the stage stays where it is.")});
    emit rehearsed(tr("The rehearsal was stopped."));
  } else {
    emit noticed({fault, tr("The rehearsal failed: %1").arg(text(told.error().message()))});
    emit rehearsed(tr("The rehearsal failed: see Notices."));
  }
}

/// On the session's thread.
void ScanController::run(ScanRequest request) {
  const QString dataset = text(request.out.string());
  auto started = ScanSession::start(std::move(request));
  if (!started) {
    QMetaObject::invokeMethod(this, [this, error = started.error()] { finish(tl::unexpected(error)); });
    return;
  }
  ScanSession& session = **started;
  {
    std::lock_guard lock(mutex_);
    session_ = std::move(*started);
    if (stop_early_) session.stop();
    session.retake(std::exchange(retake_early_, {}));
  }
  emit sessionReady(session.geometry());
  QMetaObject::invokeMethod(this, [this, geometry = session.geometry(), dataset] {
    if (activity_ == ScanActivity::starting) set_activity(ScanActivity::running);
    emit this->started(geometry, dataset);
  });
  while (auto event = session.next_event()) {
    if (const auto* cell = std::get_if<CellStored>(&*event)) emit cellReady(cell->entry.cell, cell->image);
    if (const auto* pass = std::get_if<PassStored>(&*event); pass && pass->image)
      emit passReady(pass->cell, pass->image);
    QMetaObject::invokeMethod(this, [this, event = std::move(*event)] { take(event); });
  }
  auto summary = session.wait();
  {
    std::lock_guard lock(mutex_);
    session_.reset();
  }
  QMetaObject::invokeMethod(this, [this, summary = std::move(summary)] { finish(summary); });
}

void ScanController::take(const SessionEvent& event) {
  if (const auto* progress = std::get_if<ScanProgress>(&event)) {
    progress_ = *progress;
    const bool in_trouble = !progress->trouble.empty() && activity_ == ScanActivity::running;
    if (progress->state == ScanState::paused && (activity_ == ScanActivity::pausing || in_trouble))
      set_activity(ScanActivity::paused);
    if (in_trouble && !progress->slide.empty())
      emit noticed({OperatorNotice::Level::warning, tr("Paused: %1 with Resume (F6).").arg(text(progress->trouble))});
    else if (in_trouble)
      emit noticed(
          {OperatorNotice::Level::fault, tr("Paused: %1. Resume goes on.").arg(text(progress->trouble))});
    emit progressed(*progress);
  } else if (const auto* cell = std::get_if<CellStored>(&event)) {
    emit cellStored(cell->entry, cell->image);
  } else if (const auto* pass = std::get_if<PassStored>(&event)) {
    emit passStored(pass->cell);
  } else if (const auto* reading = std::get_if<ReferenceReading>(&event)) {
    emit referenceRead(*reading);
  } else if (const auto* notice = std::get_if<Notice>(&event)) {
    emit noticed({OperatorNotice::Level::warning, text(notice->text)});
  } else if (const auto* scan = std::get_if<ScanPrediction>(&event); scan && !scan->has_room()) {
    emit noticed({OperatorNotice::Level::warning, tr("The scan: %1").arg(prediction_text(*scan))});
  }
}

void ScanController::finish(const Result<ScanSummary>& summary) {
  if (thread_.joinable()) thread_.join();  // it has nothing left to do
  set_activity(ScanActivity::idle);
  rest();
  if (!summary) {
    const bool stopped = summary.error().kind == ErrorKind::stopped;
    const QString message =
        stopped ? tr("Stopped. What is stored stays; Start goes on where it ended.") : text(summary.error().message());
    emit noticed({stopped ? OperatorNotice::Level::information : OperatorNotice::Level::fault, message});
    emit ended(false, message);
    return;
  }
  const Coverage& coverage = summary->coverage;
  const QString message = tr("Scan ended: %1 of %2 cells measured in %3 min, bench idle %4 %, %5 cells with warnings.")
                              .arg(coverage.measured)
                              .arg(coverage.total)
                              .arg(summary->timing.total_s / 60, 0, 'f', 1)
                              .arg(100 * summary->timing.idle_share(), 0, 'f', 1)
                              .arg(summary->cells_with_warnings);
  emit noticed({OperatorNotice::Level::information, message});
  emit ended(coverage.complete(), message);
}

void ScanController::pause() {
  if (activity_ != ScanActivity::running) return;
  set_activity(ScanActivity::pausing);
  with(mutex_, session_, [](ScanSession& session) { session.pause(); });
}

void ScanController::resume() {
  if (activity_ != ScanActivity::pausing && activity_ != ScanActivity::paused) return;
  set_activity(ScanActivity::running);
  with(mutex_, session_, [](ScanSession& session) { session.resume(); });
}

void ScanController::stop() {
  if (!busy()) return;
  set_activity(ScanActivity::stopping);
  std::lock_guard lock(mutex_);
  stop_early_ = true;
  rehearsal_stop_.request_stop();
  if (session_) session_->stop();
}

void ScanController::retake(const std::vector<CellIndex>& cells) {
  std::lock_guard lock(mutex_);
  if (session_)
    session_->retake(cells);
  else
    retake_early_.insert(retake_early_.end(), cells.begin(), cells.end());
}

}  // namespace lumifield
