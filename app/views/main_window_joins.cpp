#include <QCoreApplication>
#include <QDir>
#include <QDockWidget>
#include <QFileInfo>
#include <QLabel>
#include <QToolButton>
#include <utility>

#include "acquisition/scan/scan_rules.h"
#include "app/views/bench_panel.h"
#include "app/views/cell_view.h"
#include "app/views/grid_map.h"
#include "app/views/grid_view.h"
#include "app/views/main_window.h"
#include "app/views/notices_panel.h"
#include "app/views/preview_panel.h"
#include "app/views/preview_thread.h"
#include "app/views/recent_luminaires.h"
#include "app/views/scan_panel.h"

namespace lumifield {

namespace {

QString counted(int count, const QString& thing) {
  return QString("%1 %2%3").arg(count).arg(thing, count == 1 ? "" : "s");
}

/// Those that come with the program: beside its sources, or installed.
std::vector<std::filesystem::path> demo_scenes() {
  const QString program = QCoreApplication::applicationDirPath();
  std::vector<std::filesystem::path> scenes;
  for (const QString& resources : {program + "/../../resources", program + "/../share/lumifield"})
    for (const char* name : {"corner", "pillars", "road"}) {
      const QFileInfo file(QString("%1/scenes/%2/scene.json").arg(resources, name));
      if (file.exists()) scenes.emplace_back(QDir::cleanPath(file.absoluteFilePath()).toStdString());
    }
  return scenes;
}

}  // namespace

void MainWindow::join_preview() {
  preview_->connect_to(*preview_thread_, preview_thread_->live());
  preview_->set_scenes(demo_scenes());
  connect(preview_thread_, &PreviewThread::ready, this, [this](const RendererInfo& info) {
    const QString device = QString::fromStdString(info.opencl);
    device_label_->setText(device.section(',', 0, 0));
    device_label_->setToolTip(tr("Pictures are made with %1 and %2").arg(device, QString::fromStdString(info.opengl)));
  });
  connect(preview_, &PreviewPanel::sceneChosen, this, &MainWindow::show_scene);
  connect(preview_, &PreviewPanel::lampsWanted, this, [this] { show_dock(lamps_dock_); });
  connect(preview_, &PreviewPanel::noticed, notices_, &NoticesPanel::add);
  connect(workbench_.get(), &Workbench::sceneRead, preview_,
          [this](const Scene& scene, const QString& file) { preview_->set_scene(scene, file.toStdString()); });
}

void MainWindow::join_cells() {
  LuminaireModel& model = workbench_->model();
  connect(&model, &LuminaireModel::resetDone, this, [this, &model] {
    preview_->set_luminaire(*model.geometry());
    show_state();
  });
  connect(&model, &LuminaireModel::cellChanged, this, &MainWindow::show_state);
  connect(&model, &LuminaireModel::stateChanged, this, &MainWindow::show_state);
  connect(&model, &LuminaireModel::loaded, this, [this, &model](const QString& folder) {
    recent_->add(folder);
    if (workbench_->scan().busy()) return;
    ScanProgress progress;
    progress.cells_done = model.measured();
    progress.cells_total = model.total();
    scan_->set_progress(progress);
  });
  connect(grid_, &GridView::cellSelected, this, [this](CellIndex cell) {
    cell_->show_cell(cell);
    cell_dock_->show();
    cell_dock_->raise();
  });
  connect(&grid_->map(), &GridMap::selectionChanged, this, &MainWindow::show_state);
  connect(grid_, &GridView::retakeRequested, workbench_.get(), &Workbench::retake);
}

void MainWindow::join_scan() {
  ScanController& scan = workbench_->scan();
  connect(scan_, &ScanPanel::startRequested, workbench_.get(), &Workbench::start);
  connect(scan_, &ScanPanel::rehearseRequested, workbench_.get(), &Workbench::rehearse);
  connect(scan_, &ScanPanel::pauseRequested, &scan, &ScanController::pause);
  connect(scan_, &ScanPanel::resumeRequested, &scan, &ScanController::resume);
  connect(scan_, &ScanPanel::stopRequested, &scan, &ScanController::stop);
  connect(&scan, &ScanController::activityChanged, scan_, &ScanPanel::set_activity);
  connect(&scan, &ScanController::activityChanged, this, &MainWindow::show_state);
  connect(&scan, &ScanController::progressed, scan_, &ScanPanel::set_progress);
  connect(&scan, &ScanController::referenceRead, this, [this](const ReferenceReading& reading) {
    scan_->set_drift(reading.drift, workbench_->request()->plan.reference.limit);
  });
  connect(&scan, &ScanController::started, this, [this](const LuminaireGeometry& geometry, const QString& dataset) {
    scan_->clear_drift();
    // Values and variances, in FLOAT, before compression.
    const double bytes = 8.0 * static_cast<double>(geometry.measurement.pixels() * geometry.channels.size());
    scan_->set_dataset(dataset.toStdString(), bytes, geometry.sampling.cells());
    recent_->add(dataset);
  });
  connect(&scan, &ScanController::ended, this, [this](bool complete) {
    const LuminaireModel& model = workbench_->model();
    scan_->set_outcome(complete ? tr("Every cell is measured.")
                                : tr("Ended at %1 of %2 cells: see Notices").arg(model.measured()).arg(model.total()));
    show_state();
    if (close_when_idle_) close();
  });
  connect(&scan, &ScanController::rehearsed, this, [this](const QString& message) {
    scan_->set_outcome(message);
    notices_dock_->raise();
    show_state();
    if (close_when_idle_) close();
  });
  connect(workbench_.get(), &Workbench::noticed, notices_, &NoticesPanel::add);
  connect(notices_, &NoticesPanel::countsChanged, this, [this](int information, int warnings, int faults) {
    notices_badge_->setText(faults     ? counted(faults, tr("fault"))
                            : warnings ? counted(warnings, tr("warning"))
                                       : counted(information, tr("notice")));
  });
  // The tab of a list that is out of sight says what waits in it.
  connect(notices_dock_, &QDockWidget::visibilityChanged, notices_, &NoticesPanel::set_in_sight);
  connect(notices_, &NoticesPanel::unreadChanged, this, [this](int unread) {
    notices_dock_->setWindowTitle(unread > 0 ? tr("Notices (%1 new)").arg(unread) : tr("Notices"));
  });
  connect(workbench_.get(), &Workbench::noticed, this, [this](const OperatorNotice& notice) {
    if (notice.level == OperatorNotice::Level::fault) notices_dock_->raise();
  });
  connect(workbench_.get(), &Workbench::changed, this, &MainWindow::show_state);
  connect(workbench_.get(), &Workbench::prepared, this, [this] {
    show_bench();
    if (std::exchange(start_when_prepared_, false)) workbench_->start();
  });
}

/// Limits, targets and saturation of the bench to scan with.
void MainWindow::show_bench() {
  const ScanRequest& request = *workbench_->request();
  bench_->set_saturation(request.bench.sensor.saturation_dn);
  bench_->set_limits(request.bench.limits);
  const Sampling grid = sampling_of(request.bench, request.plan);
  std::vector<Vec2> targets;
  for (int k = 0; k < grid.cells(); ++k)
    targets.push_back(stage_target_mm(request.bench, grid.cell_center_mm(grid.index(k))));
  bench_->set_cell_targets(std::move(targets));
}

}  // namespace lumifield
