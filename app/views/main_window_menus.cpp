#include <QAction>
#include <QActionGroup>
#include <QApplication>
#include <QDockWidget>
#include <QMenu>
#include <QMenuBar>
#include <QMessageBox>
#include <QSettings>

#include "app/views/grid_map.h"
#include "app/views/grid_view.h"
#include "app/views/main_window.h"
#include "app/views/preview_panel.h"
#include "app/views/recent_luminaires.h"
#include "app/views/scan_controls.h"
#include "app/views/scan_panel.h"
#include "app/views/start_page.h"
#include "app/views/study_panel.h"

namespace lumifield {

void MainWindow::make_menus() {
  make_file_menu();
  QMenu* scan = menuBar()->addMenu(tr("&Scan"));
  const ScanControls& controls = scan_->controls();
  for (QAction* action : {controls.start_action(), controls.rehearse_action(), controls.pause_action(),
                          controls.resume_action(), controls.stop_action()})
    scan->addAction(action);
  scan->addSeparator();
  retake_ = scan->addAction(tr("&Retake selected cells"), QKeySequence(tr("Ctrl+T")), this,
                            [this] { grid_->map().request_retake(); });
  retake_->setToolTip(
      tr("Takes the cells selected in the grid again: next in a scan that runs, else the scan goes on"));
  retake_->setEnabled(false);
  make_view_menu();
  QMenu* help = menuBar()->addMenu(tr("&Help"));
  help->addAction(tr("&Keys"), QKeySequence::HelpContents, this, &MainWindow::show_keys);
  help->addAction(tr("&About Lumifield"), this, [this] {
    QMessageBox::about(this, tr("About Lumifield"),
                       tr("Lumifield scans lamps into light field luminaires and shows how they light a scene.\n\n"
                          "Licence: GPL-3.0-or-later."));
  });
}

void MainWindow::make_file_menu() {
  QMenu* file = menuBar()->addMenu(tr("&File"));
  file->addAction(tr("&New scan…"), QKeySequence::New, start_page_, &StartPage::choose_scan);
  file->addAction(tr("&Open luminaire…"), QKeySequence::Open, start_page_, &StartPage::choose_luminaire);
  recent_menu_ = file->addMenu(tr("Open &recent"));
  file->addAction(tr("Open s&tudy…"), QKeySequence(tr("Ctrl+Shift+O")), study_, &StudyPanel::choose);
  file->addSeparator();
  file->addAction(tr("&Quit"), QKeySequence::Quit, this, &QWidget::close);
  connect(recent_, &RecentLuminaires::changed, this, &MainWindow::show_recent);
  connect(start_page_, &StartPage::openRequested, this, &MainWindow::open);
  connect(start_page_, &StartPage::newScanRequested, this,
          [this](const QString& bench, const QString& plan, const QString& out, const QString& scene) {
            if (!scene.isEmpty()) show_scene(scene);
            new_scan(bench, plan, out, false);
          });
  show_recent();
}

void MainWindow::make_view_menu() {
  QMenu* view = menuBar()->addMenu(tr("&View"));
  view->addActions(preview_->panel_actions());
  view->addSeparator();
  int number = 1;
  for (QDockWidget* dock : {grid_dock_, cell_dock_, bench_dock_, notices_dock_, scan_dock_}) {
    view->addAction(dock->windowTitle(), QKeySequence(Qt::ALT | static_cast<Qt::Key>(Qt::Key_0 + number++)), dock,
                    [dock] { show_dock(dock); });
  }
  view->addAction(study_dock_->windowTitle(), QKeySequence(Qt::ALT | static_cast<Qt::Key>(Qt::Key_0 + number)), this,
                  &MainWindow::show_study_dock);
  view->addAction(lamps_dock_->windowTitle(), QKeySequence(Qt::ALT | static_cast<Qt::Key>(Qt::Key_0 + number + 1)),
                  this, [this] { show_dock(lamps_dock_); });
  view->addAction(tr("&Reset layout"), this, &MainWindow::lay_out);
  QMenu* themes = view->addMenu(tr("&Theme"));
  themes_ = new QActionGroup(this);
  const Theme now = theme_of(QSettings().value("window/theme").toString());
  for (const auto& [theme, name] : {std::pair(Theme::system, tr("&System")), std::pair(Theme::light, tr("&Light")),
                                    std::pair(Theme::dark, tr("&Dark"))}) {
    QAction* action = themes->addAction(name, this, [this, theme = theme] { set_theme(theme); });
    action->setCheckable(true);
    action->setChecked(theme == now);
    themes_->addAction(action);
  }
}

void MainWindow::show_dock(QDockWidget* dock) {
  dock->show();
  dock->raise();
}

void MainWindow::show_recent() {
  recent_menu_->clear();
  for (const QString& folder : recent_->folders())
    recent_menu_->addAction(folder, this, [this, folder] { open(folder); });
  recent_menu_->setEnabled(!recent_->folders().isEmpty());
  start_page_->set_recent(recent_->folders());
}

void MainWindow::show_keys() {
  QStringList keys;
  for (const QAction* action : findChildren<QAction*>())
    if (!action->shortcut().isEmpty())
      keys << QString("<tr><td><b>%1</b>&nbsp;&nbsp;</td><td>%2</td></tr>")
                  .arg(action->shortcut().toString(QKeySequence::NativeText).toHtmlEscaped(),
                       action->text().remove('&').toHtmlEscaped());
  keys.sort();
  keys << tr(
      "<tr><td><b>drag, arrow keys</b></td><td>orbit the preview; with Shift or the right button, move it; R: the "
      "scene's own view</td></tr>"
      "<tr><td><b>wheel, + and −</b></td><td>zoom</td></tr>"
      "<tr><td><b>drag a lamp</b></td><td>move it across the view; with Shift along its beam; with Ctrl, or by its "
      "arrow's tip, turn it; Esc cancels</td></tr>"
      "<tr><td><b>L, then arrow keys</b></td><td>choose a lamp and move it; with Shift along its beam; with Ctrl turn "
      "it; Esc ends it</td></tr>"
      "<tr><td><b>arrow keys in the grid</b></td><td>choose a cell; Enter shows it</td></tr>"
      "<tr><td><b>Ctrl or Shift with a click, or drag</b></td><td>select several cells in the grid: one more, up to "
      "there, those in the frame</td></tr>"
      "<tr><td><b>Shift+arrow keys, Ctrl+Space, Ctrl+A</b></td><td>the same by keys: up to there, one more or less, "
      "all</td></tr>");
  QMessageBox(QMessageBox::NoIcon, tr("Keys"), "<table>" + keys.join(QString()) + "</table>", QMessageBox::Close, this)
      .exec();
}

}  // namespace lumifield
