// Lamps grabbed in the window: the picture follows, and the scene that was arranged is kept.

#include <QAction>
#include <QApplication>
#include <QListWidget>
#include <QPushButton>
#include <QSettings>
#include <QTemporaryDir>
#include <QTest>
#include <filesystem>
#include <gtest/gtest.h>

#include "app/views/lamps_panel.h"
#include "app/views/main_window.h"
#include "app/views/preview_panel.h"
#include "app/views/preview_view.h"

namespace lumifield {
namespace {

class LampsTest : public testing::Test {
 protected:
  void SetUp() override {
    QSettings().clear();
    const std::filesystem::path corner = LUMIFIELD_SOURCE_DIR "/resources/scenes/corner";
    std::filesystem::copy(corner, place.filePath("corner").toStdString(), std::filesystem::copy_options::recursive);
    Manifest manifest;
    manifest.name = "two cells";
    LuminaireGeometry& g = manifest.geometry;
    g.planes.separation_mm = 150;
    g.sampling = {BasisKind::bell, {7.5, 7.5}, 2, 1, {0, 0}};
    g.measurement = {8, 8, {10, 10}, {0, 0}};
    g.channels = {"Y"};
    auto writer = DatasetWriter::create(place.filePath("lamp.lumi").toStdString(), manifest);
    ASSERT_TRUE(writer) << writer.error().message();
    for (const CellIndex cell : {CellIndex{0, 0}, CellIndex{0, 1}})
      ASSERT_TRUE(writer->add(cell, {8, 8, 1, std::vector<float>(64, 1.5F), {}, {}}, {0, 0}));
    window.show();
    ASSERT_TRUE(QTest::qWaitForWindowExposed(&window));
    QApplication::setActiveWindow(&window);  // there is no window manager to do it
    window.show_scene(place.filePath("corner/scene.json"));
    window.open(place.filePath("lamp.lumi"));
    view = window.findChild<PreviewView*>();
    ASSERT_TRUE(comes([](const PreviewFrame& f) { return !f.coarse && f.cells == 2; }));
  }
  template <class Wanted>
  bool comes(Wanted wanted) {
    return QTest::qWaitFor([&] { return view->frame() && wanted(*view->frame()); }, 60'000);
  }
  /// The picture shows the lamps as they are arranged now, in full.
  bool follows() {
    return comes([&](const PreviewFrame& f) {
      bool same = !f.coarse && f.placements.size() == lamps().lamps().size();
      for (std::size_t k = 0; same && k < f.placements.size(); ++k)
        same = f.placements[k].pose == lamps().lamps()[k].pose;
      return same;
    });
  }
  LampArrangement& lamps() { return view->lamps(); }
  QPoint stands(int lamp) {
    const QRectF rect = view->picture_rect();
    const PictureProjection seen(view->frame()->camera, {rect.left(), rect.top()}, {rect.width(), rect.height()});
    const Vec2 px = *seen.to_px(transform_point(lamps().lamp(lamp).pose, lamps().shape().pivot()));
    return {qRound(px.x()), qRound(px.y())};
  }
  void drag(int lamp, QPoint by, Qt::KeyboardModifiers keys = {}) {
    const QPoint from = stands(lamp);
    QTest::mousePress(view, Qt::LeftButton, keys, from);
    QTest::mouseMove(view, from + by / 2);
    QTest::mouseMove(view, from + by);
    QTest::mouseRelease(view, Qt::LeftButton, keys, from + by);
  }
  QPushButton* button(const QString& text) {
    for (auto* each : window.findChild<LampsPanel*>()->findChildren<QPushButton*>())
      if (each->text() == text) return each;
    return nullptr;
  }

  QTemporaryDir place;
  MainWindow window;
  PreviewView* view = nullptr;
};

TEST_F(LampsTest, ThePictureFollowsALampThatIsMovedTurnedAndPutBack) {
  const Pose home = lamps().lamp(0).pose;
  const auto before = view->frame()->radiance;
  drag(0, {40, -30});
  EXPECT_GT((lamps().lamp(0).pose - home).norm(), 20);
  ASSERT_TRUE(follows());
  EXPECT_NE(view->frame()->radiance->rgb, before->rgb);
  const Pose moved = lamps().lamp(0).pose;
  drag(0, {-30, 20}, Qt::ControlModifier);
  EXPECT_EQ((lamps().lamp(0).pose - moved).col(3).norm(), 0);
  EXPECT_GT((lamps().lamp(0).pose - moved).norm(), 0.1);
  ASSERT_TRUE(follows());

  const Pose turned = lamps().lamp(0).pose;
  const QPoint from = stands(0);
  QTest::mousePress(view, Qt::LeftButton, {}, from);
  QTest::mouseMove(view, from + QPoint(60, 0));
  ASSERT_NE(lamps().lamp(0).pose, turned);
  QTest::keyClick(view, Qt::Key_Escape);
  QTest::mouseRelease(view, Qt::LeftButton, {}, from + QPoint(60, 0));
  EXPECT_EQ(lamps().lamp(0).pose, turned);
  ASSERT_TRUE(follows());

  for (auto* action : window.findChild<PreviewPanel*>()->panel_actions())
    if (action->text().remove('&') == "Lamps") action->trigger();
  ASSERT_TRUE(QTest::qWaitFor([&] { return button("Back to the scene's")->isVisible(); }));
  QTest::mouseClick(button("Back to the scene's"), Qt::LeftButton);
  EXPECT_EQ(lamps().lamp(0).pose, home);
  ASSERT_TRUE(follows());
  EXPECT_EQ(view->frame()->radiance->rgb, before->rgb);
}

TEST_F(LampsTest, AnArrangedSceneIsSavedAndOpensAsItWas) {
  lamps().choose(0);
  button("Add a lamp")->click();
  drag(1, {-40, 10});
  QTest::keyClick(view, Qt::Key_Escape);
  QTest::keyClick(view, Qt::Key_Left);  // orbits again
  ASSERT_TRUE(follows());
  const std::vector<ScenePlacement> arranged = lamps().lamps();
  const SceneCamera camera = view->orbit().camera();
  ASSERT_TRUE(comes([&](const PreviewFrame& f) { return !f.coarse && f.camera.position_mm == camera.position_mm; }));
  const auto picture = view->frame()->radiance;
  const QString file = place.filePath("corner/two.json");
  window.findChild<PreviewPanel*>()->save_scene(file.toStdString());
  ASSERT_TRUE(QTest::qWaitFor([&] { return QFile::exists(file); }, 10'000));

  window.show_scene(place.filePath("corner/scene.json"));
  ASSERT_TRUE(comes([](const PreviewFrame& f) { return !f.coarse && f.cells == 2 && f.placements.size() == 1; }));
  window.show_scene(file);
  ASSERT_TRUE(comes([](const PreviewFrame& f) { return !f.coarse && f.cells == 2 && f.placements.size() == 2; }));
  ASSERT_EQ(lamps().count(), 2);
  EXPECT_EQ(lamps().lamp(1).pose, arranged[1].pose);
  // OrbitCamera turns the camera into angles and back.
  EXPECT_LT((view->orbit().camera().position_mm - camera.position_mm).norm(), 1e-9);
  EXPECT_EQ(view->frame()->radiance->rgb, picture->rgb);
}

}  // namespace
}  // namespace lumifield
