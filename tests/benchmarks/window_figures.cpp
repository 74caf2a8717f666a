// Figures and screenshots of the real window. Not a test: run it on a display (xvfb-run), alone on the machine.
//
//   lumifield-bench … -- window_figures scan PLAN OUT.lumi SHOTS    a whole scan: latencies, screenshots at 5, 50, 100
//   % window_figures open OUT.lumi SHOTS                               start and opening to the first picture; orbiting
//   lumifield-bench … -- window_figures rehearse PLAN OUT.lumi SHOTS a rehearsal: screenshots on the way and at its end
//   window_figures shots OUT.lumi FOLDER                             every panel (LUMIFIELD_THEME light or dark)
//   window_figures lamps OUT.lumi FOLDER [SCENE]                     a lamp dragged: pictures a second, screenshots
//   lumifield-bench … -- window_figures soak PLAN FOLDER MINUTES     a scan again and again: memory and waiting events

#include <QApplication>
#include <QComboBox>
#include <QDockWidget>
#include <QSettings>
#include <QTemporaryDir>
#include <QTest>
#include <cstdio>
#include <cstdlib>
#include <filesystem>

#include "app/views/cell_figures.h"
#include "app/views/grid_map.h"
#include "app/views/main_window.h"
#include "app/views/new_scan_dialog.h"
#include "app/views/notices_model.h"
#include "app/views/notices_panel.h"
#include "app/views/preview_look_bar.h"
#include "app/views/theme.h"
#include "tests/benchmarks/window_lamps.h"
#include "tests/benchmarks/window_series.h"

namespace lumifield {
namespace {

constexpr const char* scene = LUMIFIELD_SOURCE_DIR "/resources/scenes/corner/scene.json";
constexpr int patience_ms = 3'600'000;

int scan(const QString& plan, const QString& out, const QString& shots) {
  MainWindow window;
  window.show();
  Shown shown(window);
  window.show_scene(scene);
  const auto start = Clock::now();
  window.new_scan(std::getenv("LUMIFIELD_BENCH"), plan, out, true);
  ScanController& controller = window.workbench().scan();
  if (!QTest::qWaitFor([&] { return controller.activity() == ScanActivity::running; }, 60'000)) return 1;
  LoopLatency latency;
  LuminaireModel& model = window.workbench().model();
  double next_share = 0.05;
  while (controller.busy()) {
    QTest::qWait(20);
    const double share = model.total() ? static_cast<double>(model.measured()) / model.total() : 0;
    if (share >= next_share) {
      shoot(window, shots, QString("scan_%1").arg(qRound(100 * next_share), 3, 10, QChar('0')));
      next_share = next_share < 0.5 ? 0.5 : 2;
    }
  }
  const double scan_s = ms_since(start) / 1000;
  QTest::qWait(2000);
  shoot(window, shots, "scan_100");
  std::printf("scan with the window: %.1f s, %d of %d cells, %d pictures\n", scan_s, model.measured(), model.total(),
              shown.pictures);
  latency.series.print("event-loop latency", "ms");
  shown.latency.print("cell handed in to picture painted, scan running", "ms");
  return model.measured() == model.total() ? 0 : 1;
}

int rehearsal(const QString& plan, const QString& out, const QString& shots) {
  MainWindow window;
  window.show();
  window.show_scene(scene);
  window.new_scan(std::getenv("LUMIFIELD_BENCH"), plan, out, false);
  Workbench& work = window.workbench();
  if (!QTest::qWaitFor([&] { return work.why_not_start().isEmpty(); }, 60'000)) return 1;
  LoopLatency latency;
  work.rehearse();
  const auto begun = [&] { return work.scan().bench_view()->snapshot().place == "dark set 1"; };
  if (!QTest::qWaitFor(begun, 60'000)) return 1;
  QTest::qWait(300);
  shoot(window, shots, "rehearsing");
  if (!QTest::qWaitFor([&] { return !work.scan().busy(); }, 60'000)) return 1;
  QTest::qWait(500);
  shoot(window, shots, "rehearsed");
  latency.series.print("event-loop latency", "ms");
  return 0;
}

int open(const QString& dataset, const QString& shots) {
  auto start = Clock::now();
  MainWindow window;
  window.show();
  Shown shown(window);
  window.show_scene(scene);
  window.open(dataset);
  const auto first = [&](int cells) {
    return wait_until([&] { return shown.last && shown.last->cells >= cells; }, 60'000);
  };
  LuminaireModel& model = window.workbench().model();
  if (!first(1)) return 1;
  std::printf("start to first picture with light: %.0f ms (%d cells, %s)\n", ms_since(start), shown.last->cells,
              shown.last->coarse ? "coarse" : "full");
  const auto full = [&] { return shown.last && shown.last->cells == model.total() && !shown.last->coarse; };
  if (!wait_until(full, 60'000)) return 1;
  std::printf("start to full picture of all cells: %.0f ms\n", ms_since(start));
  QTest::qWait(500);

  // Opening again in a window that stands.
  shown.last.reset();
  start = Clock::now();
  window.open(dataset);
  if (!first(1)) return 1;
  std::printf("dataset from disk to first picture: %.0f ms (%d cells, %s)\n", ms_since(start), shown.last->cells,
              shown.last->coarse ? "coarse" : "full");
  if (!wait_until([&] { return shown.last->cells == model.total(); }, 60'000)) return 1;
  std::printf("dataset from disk to a picture of all %d cells: %.0f ms\n", model.total(), ms_since(start));
  if (!wait_until(full, 60'000)) return 1;
  shoot(window, shots, "opened");

  // Cells handed in one by one while nothing else runs.
  shown.latency.values.clear();
  LivePreview& live = window.workbench().live_preview();
  for (int k = 0; k < 30; ++k) {
    const CellIndex cell = model.geometry()->sampling.index(k % model.total());
    const int before = shown.pictures;
    live.add(cell, model.cell(cell)->image);
    if (!wait_until([&] { return shown.pictures > before; }, 5000)) return 1;
    QTest::qWait(60);
  }
  shown.latency.print("cell taken again (two kernel runs), handed in to painted, idle", "ms");
  live.set_luminaire(*model.geometry());
  QTest::qWait(500);
  shown.latency.values.clear();
  for (int k = 0; k < std::min(40, model.total()); ++k) {
    const CellIndex cell = model.geometry()->sampling.index(k);
    const int before = shown.pictures;
    live.add(cell, model.cell(cell)->image);
    if (!wait_until([&] { return shown.pictures > before; }, 5000)) return 1;
    QTest::qWait(60);
  }
  shown.latency.print("cell handed in to picture painted, idle", "ms");
  std::printf("picture: %dx%d\n", shown.last->shown.width_px, shown.last->shown.height_px);
  for (int k = 40; k < model.total(); ++k) {
    const CellIndex cell = model.geometry()->sampling.index(k);
    live.add(cell, model.cell(cell)->image);
  }
  if (!wait_until(full, 60'000)) return 1;

  // Orbiting by mouse for five seconds.
  auto* view = window.findChild<PreviewView*>();
  const int before = shown.pictures;
  start = Clock::now();
  QPoint at = view->rect().center();
  QTest::mousePress(view, Qt::LeftButton, {}, at);
  for (int k = 0; ms_since(start) < 5000; ++k) {
    at += QPoint(k / 40 % 2 ? -3 : 3, k / 80 % 2 ? -1 : 1);
    QTest::mouseMove(view, at);
    QTest::qWait(10);
  }
  std::printf("orbiting: %.1f pictures/s, last %dx%d\n", (shown.pictures - before) / 5.0, shown.last->shown.width_px,
              shown.last->shown.height_px);
  QTest::mouseRelease(view, Qt::LeftButton, {}, at);
  shown.last.reset();
  start = Clock::now();
  if (!wait_until(full, 60'000)) return 1;
  std::printf("full picture %.0f ms after the mouse was let go\n", ms_since(start));
  return 0;
}

/// Every panel and page.
int shots(const QString& dataset, const QString& folder) {
  MainWindow window;
  window.show();
  shoot(window, folder, "start");
  Shown shown(window);
  window.show_scene(scene);
  window.open(dataset);
  LuminaireModel& model = window.workbench().model();
  const auto full = [&] { return shown.last && shown.last->cells == model.total() && !shown.last->coarse; };
  if (!QTest::qWaitFor(full, 120'000)) return 1;
  const auto raise = [&](const char* name) {
    auto* dock = window.findChild<QDockWidget*>(name);
    dock->show();
    dock->raise();
    QTest::qWait(300);
  };
  auto* map = window.findChild<GridMap*>();
  map->choose({model.geometry()->sampling.rows / 2, model.geometry()->sampling.columns / 2});
  QTest::qWait(500);
  shoot(window, folder, "cell");
  for (auto* box : window.findChildren<QComboBox*>())
    if (box->accessibleName() == "What the cells are coloured by")
      box->setCurrentText(figure_name(CellFigure::neighbours));
  raise("bench");
  shoot(window, folder, "bench_closed");
  for (const auto level :
       {OperatorNotice::Level::information, OperatorNotice::Level::warning, OperatorNotice::Level::fault})
    window.findChild<NoticesPanel*>()->add(
        {level,
         "cell (3, 4): 1.2 % of its pixels are saturated in every exposure; 0.1 % are allowed: add a shorter "
         "exposure to the plan, then take the cell again"});
  raise("notices");
  shown.last.reset();
  window.findChild<PreviewLookBar*>()->false_colour_action()->trigger();
  if (!QTest::qWaitFor([&] { return shown.last && shown.last->look.false_colour; }, 60'000)) return 1;
  shoot(window, folder, "notices_false_colour");
  NewScanDialog dialog(&window);
  dialog.show();
  QTest::qWait(500);
  dialog.grab().save(folder + "/new_scan.png");
  return 0;
}

int notices(MainWindow& window) { return window.findChild<NoticesPanel*>()->notices().rowCount(); }

int soak(const QString& plan, const QString& folder, double minutes) {
  MainWindow window;
  window.show();
  window.show_scene(scene);
  LoopLatency latency;
  ScanController& controller = window.workbench().scan();
  const auto begin = Clock::now();
  for (int round = 0; ms_since(begin) < minutes * 60'000; ++round) {
    const QString out = QString("%1/%2.lumi").arg(folder).arg(round);
    window.new_scan(std::getenv("LUMIFIELD_BENCH"), plan, out, true);
    if (!QTest::qWaitFor([&] { return controller.busy(); }, 60'000)) {
      std::fputs("the scan does not begin: try the plan with `lumifield scan`\n", stderr);
      return 1;
    }
    if (!QTest::qWaitFor([&] { return !controller.busy(); }, patience_ms)) return 1;
    QTest::qWait(1000);
    std::printf("%6.1f min, scan %d: %d cells, resident %.1f MB, event-loop p99 %.1f ms, notices %d\n",
                ms_since(begin) / 60'000, round, window.workbench().model().measured(), resident_mb(),
                latency.series.at(0.99), notices(window));
    std::fflush(stdout);
    latency.series.values.clear();
    std::filesystem::remove_all(out.toStdString());
  }
  return 0;
}

}  // namespace
}  // namespace lumifield

int main(int argc, char** argv) {
  QApplication application(argc, argv);
  QApplication::setOrganizationName("Lumifield");
  QApplication::setApplicationName("lumifield-window-figures");
  lumifield::set_style();
  const QTemporaryDir settings;
  QSettings::setDefaultFormat(QSettings::IniFormat);
  QSettings::setPath(QSettings::IniFormat, QSettings::UserScope, settings.path());
  const QStringList words = QApplication::arguments();
  const QString theme = qEnvironmentVariable("LUMIFIELD_THEME", "light");
  QSettings().setValue("window/theme", theme);
  if (words.value(1) == "scan" && words.size() > 3) return lumifield::scan(words[2], words[3], words.value(4));
  if (words.value(1) == "rehearse" && words.size() > 4) return lumifield::rehearsal(words[2], words[3], words[4]);
  if (words.value(1) == "open" && words.size() > 2) return lumifield::open(words[2], words.value(3));
  if (words.value(1) == "shots" && words.size() > 3) return lumifield::shots(words[2], words[3]);
  if (words.value(1) == "lamps" && words.size() > 3)
    return lumifield::lamps(words[2], words[3], words.value(4, lumifield::scene));
  if (words.value(1) == "soak" && words.size() > 4) return lumifield::soak(words[2], words[3], words[4].toDouble());
  std::fputs(
      "window_figures scan PLAN OUT SHOTS | rehearse PLAN OUT SHOTS | open DATASET [SHOTS] | shots DATASET FOLDER | "
      "lamps DATASET FOLDER [SCENE] | soak PLAN FOLDER MINUTES\n",
      stderr);
  return 2;
}
