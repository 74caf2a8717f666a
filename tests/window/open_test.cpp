// The window without a bench: datasets open by drop and from the recent list; layout and theme are remembered.

#include <QAccessible>
#include <QAction>
#include <QApplication>
#include <QDockWidget>
#include <QDropEvent>
#include <QFile>
#include <QLabel>
#include <QMenu>
#include <QMenuBar>
#include <QMimeData>
#include <QSettings>
#include <QTemporaryDir>
#include <QTest>
#include <QUrl>
#include <gtest/gtest.h>

#include "app/session/study_file.h"
#include "app/views/main_window.h"
#include "app/views/notices_model.h"
#include "app/views/notices_panel.h"
#include "app/views/preview_view.h"
#include "app/views/start_page.h"
#include "app/views/study_chart.h"
#include "app/views/study_panel.h"
#include "tests/support/made_up_study.h"

namespace lumifield {
namespace {

class OpenTest : public testing::Test {
 protected:
  void SetUp() override {
    QSettings().clear();
    Manifest manifest;
    manifest.name = "half";
    LuminaireGeometry& g = manifest.geometry;
    g.planes.separation_mm = 150;
    g.sampling = {BasisKind::bell, {7.5, 7.5}, 3, 2, {0, 0}};
    g.measurement = {8, 8, {10, 10}, {0, 0}};
    g.channels = {"Y"};
    auto writer = DatasetWriter::create(folder().toStdString(), manifest);
    ASSERT_TRUE(writer) << writer.error().message();
    for (const CellIndex cell : {CellIndex{0, 0}, CellIndex{1, 1}})
      ASSERT_TRUE(writer->add(cell, {8, 8, 1, std::vector<float>(64, 1.5F), {}, {}}, {0, 0}));
  }
  std::unique_ptr<MainWindow> make_window() {
    auto window = std::make_unique<MainWindow>();
    window->show();
    EXPECT_TRUE(QTest::qWaitForWindowExposed(window.get()));
    window->show_scene(LUMIFIELD_SOURCE_DIR "/resources/scenes/corner/scene.json");
    return window;
  }
  void drop(MainWindow& window, const QString& path) {
    QMimeData data;
    data.setUrls({QUrl::fromLocalFile(path)});
    QDragEnterEvent enter({100, 100}, Qt::CopyAction, &data, Qt::LeftButton, Qt::NoModifier);
    QApplication::sendEvent(&window, &enter);
    EXPECT_TRUE(enter.isAccepted());
    QDropEvent event({100, 100}, Qt::CopyAction, &data, Qt::LeftButton, Qt::NoModifier);
    QApplication::sendEvent(&window, &event);
  }
  static bool shows(MainWindow& window, int cells) {
    return QTest::qWaitFor(
        [&] {
          const auto frame = window.findChild<PreviewView*>()->frame();
          return frame && frame->cells == cells && !frame->coarse;
        },
        60'000);
  }
  static QStringList recent(MainWindow& window) {
    QStringList names;
    for (QMenu* menu : window.menuBar()->findChildren<QMenu*>())
      if (menu->title().remove('&') == "Open recent")
        for (const QAction* action : menu->actions()) names << action->text();
    return names;
  }
  QString folder() const { return place.filePath("half.lumi"); }

  QTemporaryDir place;
};

TEST_F(OpenTest, AHalfDatasetOpensByDropAndIsRemembered) {
  auto window = make_window();
  EXPECT_TRUE(window->findChild<StartPage*>()->isVisible());
  drop(*window, folder());
  ASSERT_TRUE(shows(*window, 2));
  EXPECT_FALSE(window->findChild<StartPage*>()->isVisible());
  EXPECT_TRUE(window->windowTitle().contains("half (2 of 6 cells)")) << qPrintable(window->windowTitle());
  EXPECT_EQ(window->workbench().model().state({0, 1}), LuminaireModel::State::unmeasured);
  EXPECT_FALSE(window->workbench().why_not_start().isEmpty());
  window.reset();

  window = make_window();
  ASSERT_EQ(recent(*window), QStringList{folder()});
  for (QMenu* menu : window->menuBar()->findChildren<QMenu*>())
    if (menu->title().remove('&') == "Open recent") menu->actions().front()->trigger();
  EXPECT_TRUE(shows(*window, 2));
}

TEST_F(OpenTest, TheManifestMeansItsFolder) {
  auto window = make_window();
  drop(*window, folder() + "/luminaire.json");
  EXPECT_TRUE(shows(*window, 2));
}

TEST_F(OpenTest, WhatIsNoDatasetIsToldAndChangesNothing) {
  auto window = make_window();
  drop(*window, folder());
  ASSERT_TRUE(shows(*window, 2));
  drop(*window, place.path());
  auto* notices = window->findChild<NoticesPanel*>();
  ASSERT_TRUE(QTest::qWaitFor([&] { return notices->notices().count(OperatorNotice::Level::fault) == 1; }, 10'000));
  EXPECT_EQ(window->workbench().model().measured(), 2);
  EXPECT_EQ(window->workbench().folder(), folder().toStdString());
}

TEST_F(OpenTest, AStudyOpensByDropInADockAndIsRemembered) {
  ASSERT_TRUE(write_study(test::made_up_study(), place.path().toStdString()));
  auto window = make_window();
  auto* panel = window->findChild<StudyPanel*>();
  EXPECT_FALSE(panel->isVisible());
  drop(*window, place.filePath("study.json"));
  ASSERT_TRUE(QTest::qWaitFor([&] { return panel->isVisible() && panel->chart().isVisible(); }, 10'000));
  EXPECT_TRUE(window->findChild<StartPage*>()->isVisible());
  window->findChild<QDockWidget*>("study")->close();
  window->close();
  window.reset();

  window = make_window();
  panel = window->findChild<StudyPanel*>();
  EXPECT_FALSE(panel->isVisible());
  window->activateWindow();
  ASSERT_TRUE(QTest::qWaitForWindowActive(window.get()));
  QTest::keyClick(window.get(), Qt::Key_6, Qt::AltModifier);
  EXPECT_TRUE(QTest::qWaitFor([&] { return panel->chart().isVisible(); }, 10'000));
}

TEST_F(OpenTest, WhatIsNoStudyIsToldAndOpensNoDock) {
  auto window = make_window();
  QFile file(place.filePath("study.json"));
  ASSERT_TRUE(file.open(QIODevice::WriteOnly) && file.write("{}") == 2);
  file.close();
  drop(*window, file.fileName());
  auto* notices = window->findChild<NoticesPanel*>();
  ASSERT_TRUE(QTest::qWaitFor([&] { return notices->notices().count(OperatorNotice::Level::fault) == 1; }, 10'000));
  EXPECT_FALSE(window->findChild<StudyPanel*>()->isVisible());
}

TEST_F(OpenTest, LayoutAndThemeAreRemembered) {
  auto window = make_window();
  window->findChild<QDockWidget*>("grid")->close();
  for (QAction* action : window->findChildren<QAction*>())
    if (action->text().remove('&') == "Dark") action->trigger();
  const QColor dark = QApplication::palette().color(QPalette::Window);
  EXPECT_LT(dark.lightness(), 80);
  window->close();
  window.reset();
  apply(Theme::light);
  window = make_window();
  EXPECT_FALSE(window->findChild<QDockWidget*>("grid")->isVisible());
  EXPECT_TRUE(window->findChild<QDockWidget*>("scan")->isVisible());
  EXPECT_EQ(QApplication::palette().color(QPalette::Window), dark);
  apply(Theme::light);
}

TEST_F(OpenTest, EveryControlHasANameForScreenReaders) {
  ASSERT_TRUE(write_study(test::made_up_study(), place.path().toStdString()));
  auto window = make_window();
  drop(*window, folder());
  drop(*window, place.filePath("study.json"));
  ASSERT_TRUE(shows(*window, 2));
  auto* study = window->findChild<StudyPanel*>();
  ASSERT_TRUE(QTest::qWaitFor([&] { return study->chart().isVisible(); }, 10'000));
  for (const QWidget* widget : window->findChildren<QWidget*>()) {
    // Qt's own parts of a control ("qt_…") are read with it.
    if (!widget->isVisible() || widget->focusPolicy() == Qt::NoFocus || widget->objectName().startsWith("qt_"))
      continue;
    const QAccessibleInterface* reader = QAccessible::queryAccessibleInterface(const_cast<QWidget*>(widget));
    ASSERT_NE(reader, nullptr);
    EXPECT_FALSE(reader->text(QAccessible::Name).isEmpty())
        << widget->metaObject()->className() << " " << qPrintable(widget->objectName()) << " in "
        << (widget->parentWidget() ? widget->parentWidget()->metaObject()->className() : "-");
  }
}

}  // namespace
}  // namespace lumifield
