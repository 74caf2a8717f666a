#include <QAction>
#include <QFile>
#include <QSignalSpy>
#include <QTemporaryDir>
#include <QTest>
#include <filesystem>
#include <gtest/gtest.h>

#include "app/views/lamp_arrangement.h"
#include "app/views/preview_panel.h"
#include "app/views/preview_view.h"
#include "app/views/scene_menu.h"
#include "tests/views/preview_frames.h"

namespace lumifield {
namespace {

class PreviewPanelLampsTest : public testing::Test {
 protected:
  PreviewPanelLampsTest() {
    panel.show();
    EXPECT_TRUE(QTest::qWaitForWindowExposed(&panel));
  }

  PreviewPanel panel;
};

TEST_F(PreviewPanelLampsTest, APictureSaysWhereItsLampsStand) {
  QTemporaryDir folder;
  QSignalSpy noticed(&panel, &PreviewPanel::noticed);
  PreviewFrame frame = preview_frame(40, 30);
  frame.placements = {{}, {}};
  frame.placements[1].pose(0, 3) = 1234.5;
  frame.placements[1].scale = 0.25;
  panel.show_frame(std::make_shared<const PreviewFrame>(frame));
  panel.save_picture(folder.filePath("a.exr").toStdString());
  ASSERT_TRUE(QTest::qWaitFor([&] { return noticed.count() == 1; }, 30000));
  QFile exr(folder.filePath("a.exr"));
  ASSERT_TRUE(exr.open(QIODevice::ReadOnly));
  EXPECT_TRUE(exr.readAll().contains(
      "luminaires (pose row by row, mm; scale): [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1] 1, "
      "[1, 0, 0, 1234.5, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1] 0.25"));
}

TEST_F(PreviewPanelLampsTest, HandlesCanBeHidden) {
  Scene scene;
  scene.camera = preview_camera();
  scene.luminaires = {{}};
  panel.set_scene(scene, "/scenes/corner/scene.json");
  panel.set_luminaire(preview_luminaire());
  panel.show_ready({});
  PreviewFrame frame = preview_frame(40, 30);
  frame.camera = preview_camera();
  panel.show_frame(std::make_shared<const PreviewFrame>(frame));
  const QImage with = panel.view().grab().toImage();
  QAction* handles = nullptr;
  for (QAction* action : panel.panel_actions())
    if (action->text() == "Lamp &handles") handles = action;
  ASSERT_NE(handles, nullptr);
  handles->trigger();
  EXPECT_NE(panel.view().grab().toImage(), with);
  QTest::keyClick(&panel.view(), Qt::Key_L);
  EXPECT_EQ(panel.lamps().chosen(), -1) << "none that cannot be seen";
  handles->trigger();
  EXPECT_EQ(panel.view().grab().toImage(), with);
}

TEST_F(PreviewPanelLampsTest, SavesTheSceneAsItIsArrangedWhereItsMeshIsFound) {
  QTemporaryDir folder;
  const std::filesystem::path place = folder.path().toStdString();
  std::filesystem::create_directory(place / "elsewhere");
  Scene own;
  own.name = "corner";
  own.mesh = place / "room.obj";
  own.camera = preview_camera();
  own.luminaires = {{}};
  panel.set_scene(own, place / "scene.json");
  panel.lamps().add_copy();
  panel.view().setFocus();
  QTest::keyClick(&panel.view(), Qt::Key_Right);  // no frame yet: the camera's
  QSignalSpy noticed(&panel, &PreviewPanel::noticed);
  panel.save_scene(place / "two.json");
  ASSERT_TRUE(QTest::qWaitFor([&] { return noticed.count() == 1; }, 30000));
  EXPECT_EQ(noticed.last().at(0).value<OperatorNotice>().level, OperatorNotice::Level::information);
  const auto read = read_scene(place / "two.json");
  ASSERT_TRUE(read) << read.error().message();
  EXPECT_EQ(read->name, "two");
  EXPECT_EQ(read->camera.position_mm, panel.view().orbit().camera().position_mm);
  ASSERT_EQ(read->luminaires.size(), 2u);
  EXPECT_EQ(read->luminaires[1].pose, panel.lamps().lamp(1).pose);
  EXPECT_EQ(panel.scene_menu()->actions()[1]->text(), "two") << "it can be chosen";

  panel.save_scene(place / "elsewhere/two.json");
  ASSERT_TRUE(QTest::qWaitFor([&] { return noticed.count() == 2; }, 30000));
  EXPECT_EQ(noticed.last().at(0).value<OperatorNotice>().level, OperatorNotice::Level::fault);
  EXPECT_TRUE(noticed.last().at(0).value<OperatorNotice>().text.contains("save the scene beside it"));
  EXPECT_FALSE(std::filesystem::exists(place / "elsewhere/two.json"));
}

TEST_F(PreviewPanelLampsTest, OffersTheListOfLamps) {
  QSignalSpy wanted(&panel, &PreviewPanel::lampsWanted);
  for (QAction* action : panel.panel_actions())
    if (action->text().remove('&') == "Lamps") action->trigger();
  EXPECT_EQ(wanted.count(), 1);
}

}  // namespace
}  // namespace lumifield
