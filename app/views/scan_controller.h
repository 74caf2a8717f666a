#pragma once

#include <QObject>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

#include "app/session/bench_view.h"
#include "app/session/bench_watch.h"
#include "app/session/rehearsal.h"
#include "app/session/scan_session.h"
#include "app/views/operator_notice.h"
#include "app/views/scan_activity.h"

namespace lumifield {

/// The one QObject that adapts a scan session to Qt. Its signals come on the GUI thread; nothing here waits for a
/// device or a disk.
class ScanController : public QObject {
  Q_OBJECT

 public:
  explicit ScanController(BenchDevices devices = {}, QObject* parent = nullptr);
  /// Stops a scan that runs and waits for its end: call only when the window closes.
  ~ScanController() override;

  ScanActivity activity() const { return activity_; }
  bool busy() const { return activity_ != ScanActivity::idle; }
  const ScanProgress& progress() const { return progress_; }
  /// Where the bench thread leaves what it sees.
  const std::shared_ptr<BenchView>& bench_view() const { return bench_view_; }

  /// While no scan runs, shows what camera and stage of this bench see; an empty one ends that.
  void watch(const std::optional<Bench>& bench, double exposure_s);

 public slots:
  void start(const lumifield::ScanRequest& request);
  /// Tries the scan in small on the bench that the scan would use: `progressed`, then `rehearsed`.
  void rehearse(const lumifield::RehearsalRequest& request);
  void pause();
  void resume();
  void stop();
  /// Takes these cells again, next.
  void retake(const std::vector<lumifield::CellIndex>& cells);

 signals:
  void activityChanged(lumifield::ScanActivity activity);
  void started(const lumifield::LuminaireGeometry& geometry, const QString& dataset);
  void progressed(const lumifield::ScanProgress& progress);
  /// On the session's thread, before any cell.
  void sessionReady(const lumifield::LuminaireGeometry& geometry);
  /// On the session's thread, before `cellStored`: for those that must not wait for the GUI thread.
  void cellReady(lumifield::CellIndex cell, std::shared_ptr<const lumifield::CellImage> image);
  /// The same, of a cell of which one pass alone is measured: what that makes.
  void passReady(lumifield::CellIndex cell, std::shared_ptr<const lumifield::CellImage> image);
  void cellStored(const lumifield::CellEntry& entry, std::shared_ptr<const lumifield::CellImage> image);
  void passStored(lumifield::CellIndex cell);
  void referenceRead(const lumifield::ReferenceReading& reading);
  void noticed(const lumifield::OperatorNotice& notice);
  /// A rehearsal ended, and `noticed` said with what; `message` says how in a few words.
  void rehearsed(const QString& message);
  /// Ended: `complete` when every cell is measured. `message` says it in a sentence.
  void ended(bool complete, const QString& message);

 private:
  void set_activity(ScanActivity activity);
  void take(const SessionEvent& event);
  void run(ScanRequest request);
  void finish(const Result<ScanSummary>& summary);
  void finish_rehearsal(const Result<Rehearsal>& told);
  void rest();

  ScanActivity activity_ = ScanActivity::idle;
  ScanProgress progress_;
  const BenchDevices devices_;
  std::shared_ptr<BenchView> bench_view_ = std::make_shared<BenchView>();
  std::optional<Bench> watched_;
  double watch_exposure_s_ = 0;
  std::unique_ptr<BenchWatch> watch_;

  std::mutex mutex_;                      ///< of session_
  std::unique_ptr<ScanSession> session_;  ///< null until it has started
  bool stop_early_ = false;               ///< stop was asked for before it had
  std::vector<CellIndex> retake_early_;   ///< asked for before it had
  std::stop_source rehearsal_stop_;
  std::jthread thread_;
};

}  // namespace lumifield
