#pragma once

#include <QMainWindow>
#include <filesystem>
#include <memory>

#include "app/views/theme.h"
#include "app/views/workbench.h"

class QAction;
class QActionGroup;
class QDockWidget;
class QLabel;
class QMenu;
class QStackedWidget;
class QToolButton;

namespace lumifield {

class BenchPanel;
class CellView;
class GridView;
class LampsPanel;
class NoticesPanel;
class PreviewPanel;
class PreviewThread;
class RecentLuminaires;
class ScanPanel;
class StartPage;
class StudyPanel;

/// The one window: the scene lit by what is measured in the middle; grid, cell, bench and notices beside it; the scan
/// below. A dataset opens by menu, recent list, drop or command line, a study likewise in a window of its own. Closing
/// it while a scan runs asks, and loses nothing. Layout, theme and recent files are remembered. GUI thread.
class MainWindow : public QMainWindow {
  Q_OBJECT

 public:
  MainWindow();
  ~MainWindow() override;

  Workbench& workbench() { return *workbench_; }
  QAction* retake_action() const { return retake_; }

  /// A dataset's folder or manifest, or a study.json.
  void open(const QString& path);
  /// Prepares a scan and, when told so, starts it.
  void new_scan(const QString& bench, const QString& plan, const QString& out, bool start);
  void show_scene(const QString& file);
  /// A study.json, in the study's dock; one that cannot be read becomes a notice.
  void show_study(const QString& file);
  /// Ends a scan that runs, then closes.
  void close_without_asking();

 protected:
  void closeEvent(QCloseEvent* event) override;
  void dragEnterEvent(QDragEnterEvent* event) override;
  void dropEvent(QDropEvent* event) override;

 private:
  void make_panels();
  QDockWidget* make_dock(const QString& title, const QString& name, QWidget* content, Qt::DockWidgetArea area);
  void make_menus();
  void make_file_menu();
  void make_view_menu();
  void make_status_bar();
  void join_preview();
  void join_cells();
  void join_scan();
  void make_study();
  void lay_out();
  void lay_out_study();
  void show_study_dock();
  static void show_dock(QDockWidget* dock);
  static bool is_study(const QString& path);
  void restore();
  void save() const;
  void show_state();
  void show_bench();
  void show_recent();
  void show_keys();
  void set_theme(Theme theme);
  bool may_close();

  PreviewThread* preview_thread_;
  std::unique_ptr<Workbench> workbench_;
  RecentLuminaires* recent_;
  QStackedWidget* middle_;
  StartPage* start_page_;
  PreviewPanel* preview_;
  GridView* grid_;
  CellView* cell_;
  BenchPanel* bench_;
  NoticesPanel* notices_;
  ScanPanel* scan_;
  StudyPanel* study_ = nullptr;
  LampsPanel* lamps_ = nullptr;
  QDockWidget *grid_dock_ = nullptr, *cell_dock_ = nullptr, *bench_dock_ = nullptr, *notices_dock_ = nullptr,
              *scan_dock_ = nullptr, *study_dock_ = nullptr, *lamps_dock_ = nullptr;
  QMenu* recent_menu_ = nullptr;
  QActionGroup* themes_ = nullptr;
  QAction* retake_ = nullptr;
  QLabel *luminaire_label_ = nullptr, *device_label_ = nullptr;
  QToolButton* notices_badge_ = nullptr;
  bool start_when_prepared_ = false, close_when_idle_ = false;
};

}  // namespace lumifield
