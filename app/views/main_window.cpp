#include "app/views/main_window.h"

#include <QCloseEvent>
#include <QDockWidget>
#include <QDragEnterEvent>
#include <QFileInfo>
#include <QLabel>
#include <QMessageBox>
#include <QMimeData>
#include <QPushButton>
#include <QSettings>
#include <QStackedWidget>
#include <QStatusBar>
#include <QToolButton>
#include <QUrl>
#include <array>

#include "app/views/bench_panel.h"
#include "app/views/cell_view.h"
#include "app/views/grid_map.h"
#include "app/views/grid_view.h"
#include "app/views/lamps_panel.h"
#include "app/views/notices_panel.h"
#include "app/views/preview_panel.h"
#include "app/views/preview_text.h"
#include "app/views/preview_thread.h"
#include "app/views/recent_luminaires.h"
#include "app/views/scan_panel.h"
#include "app/views/start_page.h"

namespace lumifield {

namespace {

/// The dataset folder that a dropped or chosen path means: the folder itself, or the one of its manifest.
QString dataset_of(const QString& path) {
  const QFileInfo info(path);
  return info.fileName() == "luminaire.json" ? info.absolutePath() : path;
}

}  // namespace

MainWindow::MainWindow() {
  setAcceptDrops(true);
  setDockOptions(AnimatedDocks | AllowNestedDocks | AllowTabbedDocks);
  make_panels();
  make_menus();
  make_status_bar();
  join_preview();
  join_cells();
  join_scan();
  lay_out();
  restore();
  show_state();
}

MainWindow::~MainWindow() {
  // The scan ends before the panels that listen to it, and tells this window nothing any more.
  workbench_->scan().disconnect(this);
  workbench_->disconnect(this);
  workbench_.reset();
}

void MainWindow::make_panels() {
  preview_thread_ = new PreviewThread(this);
  workbench_ = std::make_unique<Workbench>(preview_thread_->live());
  recent_ = new RecentLuminaires(this);
  middle_ = new QStackedWidget(this);
  start_page_ = new StartPage(this);
  preview_ = new PreviewPanel(this);
  middle_->addWidget(start_page_);
  middle_->addWidget(preview_);
  setCentralWidget(middle_);
  grid_ = new GridView(workbench_->model(), this);
  cell_ = new CellView(workbench_->model(), this);
  bench_ = new BenchPanel(this);
  bench_->set_view(workbench_->scan().bench_view());
  notices_ = new NoticesPanel(this);
  scan_ = new ScanPanel(this);
  lamps_ = new LampsPanel(preview_->lamps(), this);
  grid_dock_ = make_dock(tr("Grid"), "grid", grid_, Qt::RightDockWidgetArea);
  cell_dock_ = make_dock(tr("Cell"), "cell", cell_, Qt::RightDockWidgetArea);
  bench_dock_ = make_dock(tr("Bench"), "bench", bench_, Qt::RightDockWidgetArea);
  notices_dock_ = make_dock(tr("Notices"), "notices", notices_, Qt::RightDockWidgetArea);
  lamps_dock_ = make_dock(tr("Lamps"), "lamps", lamps_, Qt::RightDockWidgetArea);
  scan_dock_ = make_dock(tr("Scan"), "scan", scan_, Qt::BottomDockWidgetArea);
  scan_dock_->setTitleBarWidget(new QWidget(this));  // its buttons say what it is
  make_study();
}

QDockWidget* MainWindow::make_dock(const QString& title, const QString& name, QWidget* content,
                                   Qt::DockWidgetArea area) {
  auto* dock = new QDockWidget(title, this);
  dock->setObjectName(name);
  dock->setWidget(content);
  dock->setAllowedAreas(Qt::AllDockWidgetAreas);
  addDockWidget(area, dock);
  return dock;
}

/// Grid over a tab of cell, bench, notices and lamps at the right; the scan along the whole bottom.
void MainWindow::lay_out() {
  setCorner(Qt::BottomRightCorner, Qt::BottomDockWidgetArea);
  setCorner(Qt::BottomLeftCorner, Qt::BottomDockWidgetArea);
  // Never all of them below each other: the window would grow to hold them.
  const std::array docks{grid_dock_, cell_dock_, bench_dock_, notices_dock_, lamps_dock_, scan_dock_};
  for (QDockWidget* dock : docks) {
    dock->setFloating(false);
    removeDockWidget(dock);
  }
  addDockWidget(Qt::BottomDockWidgetArea, scan_dock_);
  addDockWidget(Qt::RightDockWidgetArea, grid_dock_);
  splitDockWidget(grid_dock_, cell_dock_, Qt::Vertical);
  tabifyDockWidget(cell_dock_, bench_dock_);
  tabifyDockWidget(bench_dock_, notices_dock_);
  tabifyDockWidget(notices_dock_, lamps_dock_);
  for (QDockWidget* dock : docks) dock->show();
  lay_out_study();
  bench_dock_->raise();
  resizeDocks({grid_dock_, cell_dock_}, {420, 420}, Qt::Horizontal);
  resizeDocks({grid_dock_, bench_dock_}, {220, 480}, Qt::Vertical);
}

void MainWindow::restore() {
  resize(1280, 800);
  const QSettings settings;
  restoreGeometry(settings.value("window/geometry").toByteArray());
  restoreState(settings.value("window/layout").toByteArray());
  set_theme(theme_of(settings.value("window/theme").toString()));
}

void MainWindow::save() const {
  QSettings settings;
  settings.setValue("window/geometry", saveGeometry());
  settings.setValue("window/layout", saveState());
}

void MainWindow::make_status_bar() {
  luminaire_label_ = new QLabel(this);
  device_label_ = new QLabel(this);
  device_label_->setToolTip(tr("What the pictures are made with: OpenCL and OpenGL device"));
  notices_badge_ = new QToolButton(this);
  notices_badge_->setAutoRaise(true);
  notices_badge_->setText(tr("No notices"));
  notices_badge_->setToolTip(tr("Shows what the scan and the files had to say"));
  connect(notices_badge_, &QToolButton::clicked, this, [this] {
    notices_dock_->show();
    notices_dock_->raise();
  });
  statusBar()->addWidget(luminaire_label_);
  statusBar()->addPermanentWidget(device_label_);
  statusBar()->addPermanentWidget(notices_badge_);
}

/// What the whole window says: title, what may start, the middle.
void MainWindow::show_state() {
  const LuminaireModel& model = workbench_->model();
  const QString why_not = workbench_->why_not_start();
  scan_->set_startable(why_not.isEmpty(), why_not);
  const QString why_not_again = workbench_->why_not_retake();
  grid_->set_retake_possible(why_not_again.isEmpty(), why_not_again);
  retake_->setEnabled(why_not_again.isEmpty() && !grid_->map().retakable().empty());
  const bool there = model.geometry() || workbench_->request();
  preview_->set_cells({model.measured(), model.damaged()});
  middle_->setCurrentWidget(there ? static_cast<QWidget*>(preview_) : start_page_);
  if (!model.geometry()) {
    setWindowTitle(tr("Lumifield"));
    luminaire_label_->setText(
        there ? tr("Ready to scan into %1").arg(QString::fromStdString(workbench_->request()->out.string()))
              : QString());
    return;
  }
  const QString count = tr("%1 of %2 cells").arg(model.measured()).arg(model.total());
  setWindowTitle(tr("%1 (%2) — Lumifield").arg(model.name(), count));
  luminaire_label_->setText(tr("%1 · %2").arg(QString::fromStdString(workbench_->folder().string()), count));
}

void MainWindow::open(const QString& path) {
  if (is_study(path)) return show_study(path);
  workbench_->open(dataset_of(path).toStdString());
}

void MainWindow::new_scan(const QString& bench, const QString& plan, const QString& out, bool start) {
  start_when_prepared_ = start;
  workbench_->prepare(bench.toStdString(), plan.toStdString(), out.toStdString());
}

void MainWindow::show_scene(const QString& file) { workbench_->show_scene(file.toStdString()); }

void MainWindow::set_theme(Theme theme) {
  apply(theme);
  QSettings().setValue("window/theme", word_of(theme));
}

bool MainWindow::may_close() {
  if (!workbench_->scan().busy()) return true;
  if (close_when_idle_) return false;
  if (workbench_->scan().activity() == ScanActivity::rehearsing) {  // nothing is lost
    close_without_asking();
    return false;
  }
  QMessageBox question(QMessageBox::Question, tr("A scan runs"),
                       tr("Stop the scan and close?\n\nWhat is stored stays, and the scan can go on later: open the "
                          "dataset's folder with its bench and plan again."),
                       QMessageBox::NoButton, this);
  QAbstractButton* stop = question.addButton(tr("&Stop and close"), QMessageBox::AcceptRole);
  auto* keep = question.addButton(tr("&Keep scanning"), QMessageBox::RejectRole);
  question.setDefaultButton(keep);
  question.exec();
  if (question.clickedButton() != stop) return false;
  if (!workbench_->scan().busy()) return true;
  close_when_idle_ = true;
  workbench_->scan().stop();
  return false;
}

void MainWindow::close_without_asking() {
  close_when_idle_ = true;
  workbench_->scan().stop();
  if (!workbench_->scan().busy()) close();
}

void MainWindow::closeEvent(QCloseEvent* event) {
  if (!may_close()) {
    event->ignore();
    return;
  }
  save();
  event->accept();
}

void MainWindow::dragEnterEvent(QDragEnterEvent* event) {
  if (event->mimeData()->hasUrls()) event->acceptProposedAction();
}

/// study.json is a study; a .json file that is no manifest either is a scene, by its name; all else a dataset.
void MainWindow::dropEvent(QDropEvent* event) {
  for (const QUrl& url : event->mimeData()->urls()) {
    const QString path = url.toLocalFile();
    if (path.endsWith(".json") && QFileInfo(path).fileName() != "luminaire.json" && !is_study(path))
      show_scene(path);
    else
      open(path);
  }
  event->acceptProposedAction();
}

}  // namespace lumifield
