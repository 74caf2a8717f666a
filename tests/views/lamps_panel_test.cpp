#include "app/views/lamps_panel.h"

#include <QDoubleSpinBox>
#include <QListWidget>
#include <QPushButton>
#include <QTest>
#include <gtest/gtest.h>

#include "app/views/lamp_arrangement.h"
#include "app/views/lamp_pose.h"

namespace lumifield {
namespace {

class LampsPanelTest : public testing::Test {
 protected:
  LampsPanelTest() {
    ScenePlacement lamp;
    lamp.pose = with_angles(Pose::Identity(), {0, 0, 0}, {-135, -20, 0}, {0, 0, 1});
    lamp.pose.topRightCorner<3, 1>() = Vec3(1000.04, 20, 3);  // more digits than are shown
    lamps.set_scene({lamp}, {0, 0, 1});
    lamps.set_shape({{0, 0}, {100, 50}});
    panel.show();
    EXPECT_TRUE(QTest::qWaitForWindowExposed(&panel));
    QObject::connect(&lamps, &LampArrangement::placed, &panel,
                     [this](const std::vector<ScenePlacement>& all, bool moving) { told.emplace_back(all, moving); });
  }
  QDoubleSpinBox* box(const QString& name) {
    for (auto* found : panel.findChildren<QDoubleSpinBox*>())
      if (found->accessibleName() == name) return found;
    ADD_FAILURE() << name.toStdString();
    return nullptr;
  }
  QPushButton* button(const QString& text) {
    for (auto* found : panel.findChildren<QPushButton*>())
      if (found->text() == text) return found;
    ADD_FAILURE() << text.toStdString();
    return nullptr;
  }
  void type(const QString& name, const QString& text) {
    auto* at = box(name);
    at->setFocus();
    at->selectAll();
    QTest::keyClicks(at, text);
    QTest::keyClick(at, Qt::Key_Return);
  }
  QListWidget* list() { return panel.findChild<QListWidget*>(); }
  LampAngles angles(int lamp) { return angles_of(lamps.lamp(lamp).pose, {0, 0, 1}); }

  LampArrangement lamps;
  LampsPanel panel{lamps};
  std::vector<std::pair<std::vector<ScenePlacement>, bool>> told;
};

TEST_F(LampsPanelTest, ListsThemAndChoosesInBothDirections) {
  ASSERT_EQ(list()->count(), 1);
  EXPECT_EQ(list()->item(0)->text(), "Lamp 1 at 1000, 20, 3 mm") << "rounded";
  EXPECT_TRUE(list()->item(0)->toolTip().contains("yaw −135° · pitch −20° · roll 0° · scale 1"));
  EXPECT_FALSE(box("Lamp's x, mm")->isEnabled());
  list()->setCurrentRow(0);
  EXPECT_EQ(lamps.chosen(), 0);
  EXPECT_TRUE(box("Lamp's x, mm")->isEnabled());
  EXPECT_NEAR(box("Lamp's yaw, degrees")->value(), -135, 0.005);
  lamps.choose(-1);
  EXPECT_EQ(list()->currentRow(), -1);
  EXPECT_FALSE(box("Lamp's scale")->isEnabled());
  EXPECT_TRUE(told.empty());
}

TEST_F(LampsPanelTest, ANumberChangesAndTheOthersKeepTheirDigits) {
  lamps.choose(0);
  type("Lamp's y, mm", "-250.5");
  ASSERT_EQ(told.size(), 1u);
  EXPECT_TRUE(told[0].second);
  EXPECT_EQ(lamps.lamp(0).pose(1, 3), -250.5);
  EXPECT_EQ(lamps.lamp(0).pose(0, 3), 1000.04);
  ASSERT_TRUE(QTest::qWaitFor([&] { return told.size() == 2; }));
  EXPECT_FALSE(told[1].second);

  type("Lamp's roll, degrees", "30");
  EXPECT_NEAR(angles(0).roll_deg, 30, 1e-9);
  EXPECT_NEAR(angles(0).pitch_deg, -20, 1e-9);
  type("Lamp's yaw, degrees", "45");
  EXPECT_NEAR(angles(0).yaw_deg, 45, 1e-9);
  type("Lamp's pitch, degrees", "-90");
  EXPECT_NEAR(angles(0).pitch_deg, -90, 1e-9);
  type("Lamp's scale", "0.25");
  EXPECT_EQ(lamps.lamp(0).scale, 0.25);
  EXPECT_EQ(lamps.lamp(0).pose(0, 3), 1000.04);
}

TEST_F(LampsPanelTest, AddsACopyBesideRemovesAndGoesBack) {
  EXPECT_FALSE(button("Remove")->isEnabled());
  lamps.choose(0);
  EXPECT_FALSE(button("Remove")->isEnabled()) << "one stays";
  QTest::mouseClick(button("Add a lamp"), Qt::LeftButton);
  ASSERT_EQ(lamps.count(), 2);
  EXPECT_EQ(lamps.chosen(), 1);
  EXPECT_EQ(list()->currentRow(), 1);
  const Vec3 beside = lamps.lamp(1).pose.topRightCorner<3, 1>() - lamps.lamp(0).pose.topRightCorner<3, 1>();
  EXPECT_LT((beside - 300 * lamps.lamp(0).pose.block<3, 1>(0, 0)).norm(), 1e-9) << "half its width is between them";
  ASSERT_EQ(told.size(), 1u);
  EXPECT_FALSE(told[0].second);
  EXPECT_EQ(told[0].first.size(), 2u);

  lamps.choose(0);
  QTest::mouseClick(button("Remove"), Qt::LeftButton);
  EXPECT_EQ(lamps.count(), 1);
  EXPECT_EQ(lamps.chosen(), 0);
  EXPECT_EQ(told.back().first.size(), 1u);
  EXPECT_GT(std::abs(lamps.lamp(0).pose(0, 3) - 1000.04), 1);
  QTest::mouseClick(button("Back to the scene's"), Qt::LeftButton);
  EXPECT_EQ(told.back().first.at(0).pose(0, 3), 1000.04);
}

TEST_F(LampsPanelTest, EveryControlSaysWhatItIs) {
  for (QWidget* control : panel.findChildren<QWidget*>()) {
    if (control->focusPolicy() == Qt::NoFocus || control->parentWidget()->inherits("QAbstractSpinBox")) continue;
    EXPECT_FALSE(control->toolTip().isEmpty()) << control->metaObject()->className();
    EXPECT_FALSE(control->accessibleName().isEmpty() && control->property("text").toString().isEmpty());
  }
  EXPECT_LE(panel.minimumSizeHint().width(), 420) << "the width of the docks";
}

}  // namespace
}  // namespace lumifield
