// The real window on the virtual bench, driven by mouse and keys: GigE Vision and serial traffic behind it.

#include <QAbstractButton>
#include <QAction>
#include <QApplication>
#include <QFileInfo>
#include <QMessageBox>
#include <QPushButton>
#include <QSignalSpy>
#include <QTemporaryDir>
#include <QTest>
#include <QTimer>
#include <cstdlib>
#include <gtest/gtest.h>

#include "app/views/grid_map.h"
#include "app/views/main_window.h"
#include "app/views/notices_model.h"
#include "app/views/notices_panel.h"
#include "app/views/preview_panel.h"
#include "app/views/preview_view.h"
#include "app/views/scan_controls.h"
#include "app/views/scan_panel.h"

namespace lumifield {
namespace {

constexpr int patience_ms = 120'000;

class WindowTest : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_NE(std::getenv("LUMIFIELD_BENCH"), nullptr) << "run it through lumifield-bench";
    open_window();
  }
  void open_window() {
    window = std::make_unique<MainWindow>();
    window->show();
    ASSERT_TRUE(QTest::qWaitForWindowExposed(window.get()));
    QApplication::setActiveWindow(window.get());  // there is no window manager to do it
    window->show_scene(LUMIFIELD_SOURCE_DIR "/resources/scenes/corner/scene.json");
  }
  void scan_into(const QString& name) {
    window->new_scan(std::getenv("LUMIFIELD_BENCH"), LUMIFIELD_SOURCE_DIR "/tests/app/plans/small.json", folder(name),
                     true);
  }
  QString folder(const QString& name) const { return place.filePath(name); }
  LuminaireModel& model() { return window->workbench().model(); }
  ScanActivity activity() { return window->workbench().scan().activity(); }
  template <class Condition>
  [[nodiscard]] bool wait_for(Condition condition) {
    return QTest::qWaitFor(condition, patience_ms);
  }
  /// A button that shows this action.
  QAbstractButton* button(const QAction* action) {
    const QString words = action->text().remove('&');
    for (QAbstractButton* each : window->findChildren<QAbstractButton*>())
      if (each->isVisible() && each->isEnabled() && each->text().remove('&') == words) return each;
    return nullptr;
  }
  void press(const QAction* action) {
    QAbstractButton* found = button(action);
    ASSERT_NE(found, nullptr) << qPrintable(action->text());
    QTest::mouseClick(found, Qt::LeftButton);
  }
  ScanControls& controls() { return window->findChild<ScanPanel*>()->controls(); }
  std::shared_ptr<const PreviewFrame> shown() { return window->findChild<PreviewView*>()->frame(); }
  Result<DatasetIndex> index(const QString& name) { return read_dataset_index(folder(name).toStdString()); }

  QTemporaryDir place;
  std::unique_ptr<MainWindow> window;
};

TEST_F(WindowTest, RehearsesBeforeTheScan) {
  window->new_scan(std::getenv("LUMIFIELD_BENCH"), LUMIFIELD_SOURCE_DIR "/tests/app/plans/small.json",
                   folder("lamp.lumi"), false);
  ASSERT_TRUE(wait_for([&] { return controls().rehearse_action()->isEnabled(); }));
  QSignalSpy rehearsed(&window->workbench().scan(), &ScanController::rehearsed);
  press(controls().rehearse_action());
  EXPECT_EQ(activity(), ScanActivity::rehearsing);
  ASSERT_TRUE(wait_for([&] { return rehearsed.count() == 1; }));
  const NoticesModel& notices = window->findChild<NoticesPanel*>()->notices();
  EXPECT_EQ(notices.count(OperatorNotice::Level::fault), 0);
  const QString told = notices.line(notices.rowCount() - 1);
  EXPECT_TRUE(told.contains("8 corner places reached; test shot of cell (1, 2)")) << qPrintable(told);
  EXPECT_TRUE(told.contains("the scan: 20 cells, about")) << qPrintable(told);

  // Once more, stopped at once.
  press(controls().rehearse_action());
  press(controls().stop_action());
  ASSERT_TRUE(wait_for([&] { return rehearsed.count() == 2; }));
  EXPECT_EQ(rehearsed[1][0].toString(), "The rehearsal was stopped.");

  // Closing the window ends it without a question.
  press(controls().rehearse_action());
  window->close();
  ASSERT_TRUE(wait_for([&] { return !window->isVisible(); }));
  EXPECT_EQ(activity(), ScanActivity::idle);
  EXPECT_FALSE(QFileInfo::exists(folder("lamp.lumi")));
}

TEST_F(WindowTest, ScansWithAPauseAndARetake) {
  scan_into("lamp.lumi");
  ASSERT_TRUE(wait_for([&] { return model().measured() >= 3; }));

  // A pause holds the scan where it is.
  press(controls().pause_action());
  ASSERT_TRUE(wait_for([&] { return activity() == ScanActivity::paused; }));
  ScanController& scan = window->workbench().scan();
  const int held = scan.progress().cells_done;
  EXPECT_LT(held, model().total());
  ASSERT_TRUE(wait_for([&] { return model().measured() == held; })) << "the cells that were on their way";
  QSignalSpy progressed(&scan, &ScanController::progressed);
  press(controls().resume_action());
  ASSERT_TRUE(wait_for([&] { return progressed.count() > 0; }));
  EXPECT_EQ(progressed[0][0].value<ScanProgress>().cells_done, held) << "none was measured in the pause";
  ASSERT_TRUE(wait_for([&] { return model().measured() > held; }));

  // A measured cell is chosen with the mouse and taken again with the key.
  CellIndex chosen{-1, -1};
  for (int k = 0; k < model().total() && chosen.row < 0; ++k) {
    const CellIndex cell = model().geometry()->sampling.index(k);
    if (model().cell(cell)) chosen = cell;
  }
  auto* map = window->findChild<GridMap*>();
  QTest::mouseClick(map, Qt::LeftButton, {}, map->cell_rect(chosen).center().toPoint());
  ASSERT_TRUE(window->retake_action()->isEnabled());
  QTest::keySequence(window.get(), window->retake_action()->shortcut());
  ASSERT_TRUE(wait_for([&] { return activity() == ScanActivity::idle; }));

  EXPECT_EQ(model().measured(), model().total());
  EXPECT_EQ(model().cell(chosen)->entry.generation, 2);
  ASSERT_TRUE(wait_for([&] { return shown() && shown()->cells == model().total() && !shown()->coarse; }));
  const auto report = check_dataset(folder("lamp.lumi").toStdString());
  ASSERT_TRUE(report) << report.error().message();
  EXPECT_TRUE(report->problems.empty()) << report->problems.front();
  EXPECT_TRUE(report->coverage.complete());
}

TEST_F(WindowTest, ClosedInMidScanItAsksLosesNothingAndGoesOn) {
  scan_into("half.lumi");
  ASSERT_TRUE(wait_for([&] { return model().measured() >= 4; }));

  // The first answer keeps it open and scanning.
  const auto answer = [&](const QString& words) {
    auto* timer = new QTimer(window.get());
    QObject::connect(timer, &QTimer::timeout, window.get(), [timer, words] {
      auto* box = qobject_cast<QMessageBox*>(QApplication::activeModalWidget());
      if (!box) return;
      timer->deleteLater();
      for (QAbstractButton* each : box->buttons())
        if (each->text().remove('&') == words) QTest::mouseClick(each, Qt::LeftButton);
    });
    timer->start(50);
  };
  answer("Keep scanning");
  EXPECT_FALSE(window->close());
  EXPECT_TRUE(window->isVisible());
  EXPECT_EQ(activity(), ScanActivity::running);
  answer("Stop and close");
  window->close();
  ASSERT_TRUE(wait_for([&] { return !window->isVisible(); }));
  const int measured = model().measured();
  window.reset();

  const auto half = index("half.lumi");
  ASSERT_TRUE(half) << half.error().message();
  EXPECT_EQ(half->manifest.cells.size(), static_cast<std::size_t>(measured));
  EXPECT_LT(measured, 20);

  // Without a bench the half dataset opens and is shown.
  open_window();
  window->open(folder("half.lumi"));
  ASSERT_TRUE(wait_for([&] { return model().measured() == measured; }));
  ASSERT_TRUE(wait_for([&] { return shown() && shown()->cells == measured; }));
  EXPECT_FALSE(controls().start_action()->isEnabled());

  // With its bench the scan goes on; what was measured stays as it is.
  scan_into("half.lumi");
  ASSERT_TRUE(wait_for([&] { return activity() == ScanActivity::running; }));
  ASSERT_TRUE(wait_for([&] { return activity() == ScanActivity::idle; }));
  EXPECT_EQ(model().measured(), 20);
  const auto whole = index("half.lumi");
  ASSERT_TRUE(whole) << whole.error().message();
  for (const CellEntry& before : half->manifest.cells) {
    const auto& cells = whole->manifest.cells;
    const auto after =
        std::find_if(cells.begin(), cells.end(), [&](const CellEntry& c) { return c.cell == before.cell; });
    ASSERT_NE(after, cells.end());
    EXPECT_EQ(after->sha256, before.sha256);
  }
  ASSERT_TRUE(wait_for([&] { return shown() && shown()->cells == 20; }));
}

TEST_F(WindowTest, StopAsksInItsPlaceAndTheScanGoesOnAfterStart) {
  scan_into("stopped.lumi");
  ASSERT_TRUE(wait_for([&] { return model().measured() >= 2; }));
  QTest::keySequence(window.get(), controls().stop_action()->shortcut());
  ASSERT_TRUE(controls().asks_to_stop());
  QAbstractButton* sure = nullptr;
  for (QAbstractButton* each : controls().findChildren<QAbstractButton*>())
    if (each->isVisible() && each->text().remove('&').startsWith("Stop")) sure = each;
  ASSERT_NE(sure, nullptr);
  QTest::mouseClick(sure, Qt::LeftButton);
  ASSERT_TRUE(wait_for([&] { return activity() == ScanActivity::idle; }));
  const int measured = model().measured();
  EXPECT_LT(measured, 20);
  press(controls().start_action());
  ASSERT_TRUE(wait_for([&] { return model().measured() > measured; }));
  ASSERT_TRUE(wait_for([&] { return activity() == ScanActivity::idle; }));
  EXPECT_EQ(model().measured(), 20);
}

}  // namespace
}  // namespace lumifield
