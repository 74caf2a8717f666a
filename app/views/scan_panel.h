#pragma once

#include <QDateTime>
#include <QWidget>
#include <filesystem>
#include <functional>

#include "acquisition/scan/scanner.h"
#include "app/views/scan_activity.h"

class QGridLayout;
class QLabel;
class QProgressBar;
class QTimer;

namespace lumifield {

class DiskWatch;
class FigureGrid;
class ScanControls;

/// The scan at a glance: how far it is, what the bench is doing, when it ends, whether the disk suffices and the lamp
/// is steady; start, rehearse, pause, resume, stop. It shows what it is told and asks for what is pressed. At least
/// 1100 px wide it is about 80 px high, else one column. GUI thread.
class ScanPanel : public QWidget {
  Q_OBJECT

 public:
  using Clock = std::function<QDateTime()>;

  explicit ScanPanel(
      QWidget* parent = nullptr, Clock clock = [] { return QDateTime::currentDateTime(); });

  void set_activity(ScanActivity activity);
  void set_progress(const ScanProgress& progress);
  /// The last reading of the reference cell; |drift| above `limit` is a warning.
  void set_drift(double drift, double limit);
  /// No reading yet.
  void clear_drift();
  /// Where the scan is stored: its disk is watched. `cell_bytes`: what one cell takes at most.
  void set_dataset(const std::filesystem::path& folder, double cell_bytes, int cells_per_scan);
  /// Whether there is something to start; `why_not` is the button's tooltip if not.
  void set_startable(bool startable, const QString& why_not = {});
  /// How the last scan ended, shown while none runs.
  void set_outcome(const QString& sentence);

  /// Their actions are for the menu.
  ScanControls& controls() { return *controls_; }

  QSize sizeHint() const override;
  QSize minimumSizeHint() const override;

 signals:
  void startRequested();
  void rehearseRequested();
  void pauseRequested();
  void resumeRequested();
  void stopRequested();

 protected:
  void resizeEvent(QResizeEvent* event) override;

 private:
  enum Figure { elapsed, left, end, drift, disk };

  QWidget* make_progress();
  void arrange(bool wide);
  void show_words();
  void show_bar();
  void show_times();
  void show_disk();

  Clock clock_;
  ScanActivity activity_ = ScanActivity::idle;
  ScanProgress progress_;
  QDateTime told_;  ///< when `progress_` came, or the pause began
  QString outcome_, disk_fault_;
  double free_bytes_ = -1, cell_bytes_ = 0;
  int cells_per_scan_ = 0;
  bool wide_ = true;

  QLabel* words_ = nullptr;
  QProgressBar* bar_ = nullptr;
  QWidget* progress_block_;
  FigureGrid* figures_;
  ScanControls* controls_;
  QGridLayout* blocks_;
  QTimer* tick_;
  DiskWatch* disk_watch_;
};

}  // namespace lumifield
