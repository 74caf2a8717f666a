#include "app/views/scan_panel.h"

#include <QGridLayout>
#include <QLabel>
#include <QProgressBar>
#include <QResizeEvent>
#include <QTimer>
#include <QVBoxLayout>
#include <cmath>

#include "app/views/disk_watch.h"
#include "app/views/figure_grid.h"
#include "app/views/scan_controls.h"
#include "app/views/scan_words.h"

namespace lumifield {

namespace {

constexpr int wide_px = 1100, narrowest_px = 360;

}  // namespace

ScanPanel::ScanPanel(QWidget* parent, Clock clock)
    : QWidget(parent),
      clock_(std::move(clock)),
      progress_block_(make_progress()),
      figures_(new FigureGrid({{"Elapsed", "0:00:00"},
                               {"Time left", "0:00:00"},
                               {"Ends", "Wed 00:00"},
                               {"Drift", "+0.00 % ⚠"},
                               {"Disk left", "888 GB, room for 888 scans"}},
                              this)),
      controls_(new ScanControls(this)),
      blocks_(new QGridLayout(this)),
      tick_(new QTimer(this)),
      disk_watch_(new DiskWatch(this)) {
  setAccessibleName("Scan");
  blocks_->setHorizontalSpacing(24);
  // The minimum is that of the narrow arrangement, also while it is wide.
  blocks_->setSizeConstraint(QLayout::SetNoConstraint);
  arrange(true);
  connect(controls_, &ScanControls::startRequested, this, &ScanPanel::startRequested);
  connect(controls_, &ScanControls::rehearseRequested, this, &ScanPanel::rehearseRequested);
  connect(controls_, &ScanControls::pauseRequested, this, &ScanPanel::pauseRequested);
  connect(controls_, &ScanControls::resumeRequested, this, &ScanPanel::resumeRequested);
  connect(controls_, &ScanControls::stopRequested, this, &ScanPanel::stopRequested);
  connect(disk_watch_, &DiskWatch::roomRead, this, [this](double free_bytes) {
    free_bytes_ = free_bytes;
    disk_fault_.clear();
    show_disk();
  });
  connect(disk_watch_, &DiskWatch::failed, this, [this](const QString& message) {
    disk_fault_ = message;
    show_disk();
  });
  tick_->setInterval(1000);
  connect(tick_, &QTimer::timeout, this, &ScanPanel::show_times);
  clear_drift();
  show_words();
  show_bar();
  show_times();
  show_disk();
}

QWidget* ScanPanel::make_progress() {
  auto* block = new QWidget(this);
  auto* rows = new QVBoxLayout(block);
  rows->setContentsMargins(0, 0, 0, 0);
  rows->setSpacing(2);
  bar_ = new QProgressBar(block);
  bar_->setAccessibleName("Cells measured");
  bar_->setToolTip("Cells that are measured, of those that the plan asks for");
  words_ = new QLabel(block);
  words_->setAccessibleName("What the bench is doing");
  words_->setTextFormat(Qt::PlainText);
  words_->setSizePolicy(QSizePolicy::Ignored, QSizePolicy::Preferred);
  rows->addWidget(bar_);
  rows->addWidget(words_);
  return block;
}

void ScanPanel::arrange(bool wide) {
  figures_->set_columns(wide ? 5 : 3);
  blocks_->addWidget(progress_block_, 0, 0, Qt::AlignVCenter);
  blocks_->addWidget(figures_, wide ? 0 : 1, wide ? 1 : 0);
  blocks_->addWidget(controls_, wide ? 0 : 2, wide ? 2 : 0, wide ? Qt::AlignVCenter : Qt::AlignTop);
  blocks_->setColumnStretch(0, 1);
  blocks_->setRowStretch(3, wide ? 0 : 1);
  blocks_->setVerticalSpacing(wide ? 0 : 8);
}

void ScanPanel::set_activity(ScanActivity activity) {
  if (activity == activity_) return;
  if (activity_ == ScanActivity::idle) outcome_.clear();
  activity_ = activity;
  controls_->set_activity(activity);
  using enum ScanActivity;
  if (activity == starting) {
    progress_ = {};
    clear_drift();
  }
  show_words();
  show_bar();
  show_times();
}

void ScanPanel::set_progress(const ScanProgress& progress) {
  if (activity_ == ScanActivity::rehearsing) {
    // Its cells are not the scan's.
    progress_.state = progress.state;
    progress_.place = progress.place;
    return show_words();
  }
  progress_ = progress;
  told_ = clock_();
  show_words();
  show_bar();
  show_times();
  show_disk();
}

void ScanPanel::set_drift(double drift_now, double limit) {
  const QString tip = "Reference cell, last reading against the first; above " + drift_text(limit).mid(1) + " it warns";
  figures_->show_figure(drift, drift_text(drift_now), tip, std::abs(drift_now) > limit);
}

void ScanPanel::clear_drift() {
  figures_->show_figure(drift, "—", "The reference cell's last reading against the first, in %; none yet");
}

void ScanPanel::set_dataset(const std::filesystem::path& folder, double cell_bytes, int cells_per_scan) {
  cell_bytes_ = cell_bytes;
  cells_per_scan_ = cells_per_scan;
  free_bytes_ = -1;
  disk_fault_.clear();
  disk_watch_->watch(folder);
  show_disk();
}

void ScanPanel::set_startable(bool startable, const QString& why_not) { controls_->set_startable(startable, why_not); }

void ScanPanel::set_outcome(const QString& sentence) {
  outcome_ = sentence;
  show_words();
}

void ScanPanel::show_words() {
  const bool ended = activity_ == ScanActivity::idle && !outcome_.isEmpty();
  const QString text = ended ? outcome_ : bench_words(activity_, progress_);
  words_->setText(text);
  words_->setToolTip(text);
}

void ScanPanel::show_bar() {
  const int total = progress_.cells_total;
  bar_->setRange(0, std::max(total, 1));
  bar_->setValue(total > 0 ? progress_.cells_done : 0);
  const QString pass = progress_.pass.empty() ? "" : ", pass '" + QString::fromStdString(progress_.pass) + "'";
  bar_->setFormat(total > 0 ? QString("%1 of %2 cells").arg(progress_.cells_done).arg(total) + pass
                            : QString("no cells yet"));
}

/// Between two words from the bench the clock goes on, but not in a pause.
void ScanPanel::show_times() {
  using enum ScanActivity;
  const bool runs = activity_ == running || activity_ == pausing;
  runs ? tick_->start() : tick_->stop();
  const bool known = progress_.cells_total > 0;
  const QDateTime now = clock_();
  const double since_s = runs && told_.isValid() ? static_cast<double>(told_.msecsTo(now)) / 1000 : 0;
  const double left_s = std::max(0.0, progress_.left_s - since_s);
  const bool going = known && (runs || activity_ == paused);
  figures_->show_figure(elapsed, known ? duration_text(progress_.elapsed_s + since_s) : "—",
                        "Time since the scan began, pauses included, min:s");
  figures_->show_figure(left, going ? duration_text(left_s) : "—", "Predicted time that the scan still takes, min:s");
  const QDateTime ends = now.addMSecs(static_cast<qint64>(1000 * left_s));
  figures_->show_figure(end, going ? clock_text(ends, now) : "—",
                        activity_ == paused ? "When the scan would end if it went on now" : "When the scan will end");
}

void ScanPanel::show_disk() {
  if (!disk_fault_.isEmpty()) return figures_->show_figure(disk, "unknown", disk_fault_, true);
  if (free_bytes_ < 0)
    return figures_->show_figure(disk, "—", "Room on the disk that the scan is stored on, in GB; not read yet");
  const int needed = activity_ == ScanActivity::idle ? cells_per_scan_ : progress_.cells_total - progress_.cells_done;
  const bool short_of = free_bytes_ < needed * cell_bytes_;
  const QString room = room_text(free_bytes_, cell_bytes_, cells_per_scan_);
  figures_->show_figure(disk, bytes_text(free_bytes_) + (room.isEmpty() ? "" : ", " + room),
                        short_of ? QString("Too little for the %1 cells to come, which take up to %2: free some")
                                       .arg(needed)
                                       .arg(bytes_text(needed * cell_bytes_))
                                 : QString("Room on the disk that the scan is stored on, in GB"),
                        short_of);
}

QSize ScanPanel::sizeHint() const { return {std::max(width(), 400), blocks_->sizeHint().height()}; }

QSize ScanPanel::minimumSizeHint() const { return {narrowest_px, blocks_->minimumSize().height()}; }

void ScanPanel::resizeEvent(QResizeEvent* event) {
  const bool wide = event->size().width() >= wide_px;
  if (wide != wide_) {
    wide_ = wide;
    arrange(wide);
    updateGeometry();
  }
  QWidget::resizeEvent(event);
}

}  // namespace lumifield
