#include <QDir>
#include <QDockWidget>
#include <QFileInfo>
#include <QSettings>

#include "app/session/study_file.h"
#include "app/views/main_window.h"
#include "app/views/notices_panel.h"
#include "app/views/study_panel.h"

namespace lumifield {

namespace {

constexpr const char* key = "study/last";
constexpr QSize own_size(1000, 720);

QString study_name() {
  return QString::fromUtf8(study_file_name.data(), static_cast<qsizetype>(study_file_name.size()));
}

}  // namespace

/// A chart wants more room than the docks at the side have: a window of its own, until it is docked.
void MainWindow::make_study() {
  study_ = new StudyPanel(this);
  study_dock_ = make_dock(tr("Study"), "study", study_, Qt::RightDockWidgetArea);
  study_->remember(QSettings().value(key).toString());
  connect(study_, &StudyPanel::opened, this, [this](const QString& file) {
    QSettings().setValue(key, QDir::cleanPath(QFileInfo(file).absoluteFilePath()));
    if (!study_->isVisible()) show_study_dock();
  });
  connect(study_, &StudyPanel::noticed, notices_, &NoticesPanel::add);
  connect(study_, &StudyPanel::noticed, notices_dock_, &QWidget::raise);
}

void MainWindow::lay_out_study() {
  // Its place once it is docked.
  study_dock_->setFloating(false);
  removeDockWidget(study_dock_);
  addDockWidget(Qt::RightDockWidgetArea, study_dock_);
  tabifyDockWidget(notices_dock_, study_dock_);
  study_dock_->setFloating(true);
  study_dock_->resize(own_size);
  study_dock_->hide();
}

void MainWindow::show_study_dock() {
  if (study_dock_->isFloating() && !study_dock_->isVisible())
    study_dock_->move(geometry().center() - study_dock_->rect().center());
  study_dock_->show();
  study_dock_->raise();
  study_dock_->activateWindow();
}

void MainWindow::show_study(const QString& file) { study_->open(file); }

bool MainWindow::is_study(const QString& path) { return QFileInfo(path).fileName() == study_name(); }

}  // namespace lumifield
