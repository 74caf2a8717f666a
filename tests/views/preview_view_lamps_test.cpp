#include <QApplication>
#include <QHelpEvent>
#include <QSignalSpy>
#include <QTest>
#include <QToolTip>
#include <gtest/gtest.h>

#include "app/views/lamp_pose.h"
#include "app/views/preview_view.h"
#include "tests/views/preview_frames.h"

namespace lumifield {
namespace {

/// A view of 400 × 300 on the screen; a lamp at the target, its beam across the view, and one 200 mm beside it.
class PreviewViewLampsTest : public testing::Test {
 protected:
  PreviewViewLampsTest() {
    lamps[0].pose = with_angles(Pose::Identity(), {0, 0, 0}, {0, 0, 0}, {0, 0, 1});
    lamps[1].pose = with_angles(Pose::Identity(), {0, 0, 0}, {90, 0, 0}, {0, 0, 1});
    lamps[1].pose(0, 3) = 200;
    lamps[1].scale = 0.5;
    view.resize(400, 300);
    view.set_scene(preview_camera(), lamps);
    view.set_luminaire(preview_luminaire());
    view.show();
    EXPECT_TRUE(QTest::qWaitForWindowExposed(&view));
    view.activateWindow();
    view.setFocus();
    PreviewFrame frame = preview_frame(400, 300);
    frame.camera = preview_camera();
    view.show_frame(std::make_shared<const PreviewFrame>(std::move(frame)));
    QObject::connect(&view.lamps(), &LampArrangement::placed, &view,
                     [this](const std::vector<ScenePlacement>& all, bool moving) { told.emplace_back(all, moving); });
  }
  QPoint at(const Vec3& point) const {
    const Vec2 px = *projection.to_px(point);
    return {static_cast<int>(std::lround(px.x())), static_cast<int>(std::lround(px.y()))};
  }
  void press(QPoint p, Qt::KeyboardModifiers keys = {}) { QTest::mousePress(&view, Qt::LeftButton, keys, p); }
  void move(QPoint p, Qt::MouseButtons buttons = Qt::LeftButton) {
    QMouseEvent event(QEvent::MouseMove, p, view.mapToGlobal(p), Qt::NoButton, buttons, {});
    QApplication::sendEvent(&view, &event);
  }
  void release(QPoint p) { QTest::mouseRelease(&view, Qt::LeftButton, {}, p); }
  const Pose& pose(int lamp) const { return const_cast<PreviewView&>(view).lamps().lamp(lamp).pose; }
  Vec3 place(int lamp) const { return pose(lamp).topRightCorner<3, 1>(); }
  LampAngles angles(int lamp) const { return angles_of(pose(lamp), {0, 0, 1}); }
  QString said() const { return view.accessibleDescription(); }

  const PictureProjection projection{preview_camera(), {0, 0}, {400, 300}};
  std::vector<ScenePlacement> lamps{2};
  std::vector<std::pair<std::vector<ScenePlacement>, bool>> told;
  PreviewView view;
};

/// Pixels are whole: half a one each way, at some 2.5 mm.
constexpr double half_px_mm = 2;

TEST_F(PreviewViewLampsTest, ADraggedLampFollowsTheCursorAndRestsWhenLetGo) {
  QSignalSpy camera(&view, &PreviewView::cameraChanged);
  press(at({0, 0, 0}));
  EXPECT_EQ(view.lamps().chosen(), 0);
  move(at({0, 0, 0}) + QPoint(30, -20));
  ASSERT_EQ(told.size(), 1u);
  EXPECT_TRUE(told[0].second);
  EXPECT_EQ(told[0].first.size(), 2u);
  move(at({0, 0, 0}) + QPoint(60, -40));
  release(at({0, 0, 0}) + QPoint(60, -40));
  ASSERT_EQ(told.size(), 3u);
  EXPECT_FALSE(told[2].second);
  const Vec3 expected = 60 * projection.mm_per_px({0, 0, 0}) * projection.right() +
                        40 * projection.mm_per_px({0, 0, 0}) * projection.up();
  EXPECT_LT((place(0) - expected).norm(), 1e-6);
  EXPECT_EQ(told[2].first[0].pose, pose(0));
  EXPECT_EQ(pose(1), lamps[1].pose);
  EXPECT_EQ(camera.count(), 0);
  QTest::qWait(2 * LampArrangement::rest_ms);
  EXPECT_EQ(told.size(), 3u) << "it rests already";
}

TEST_F(PreviewViewLampsTest, ALampHeldStillRests) {
  press(at({0, 0, 0}));
  move(at({0, 0, 0}) + QPoint(30, 0));
  ASSERT_TRUE(QTest::qWaitFor([&] { return told.size() == 2; }));
  EXPECT_FALSE(told[1].second);
  move(at({0, 0, 0}) + QPoint(31, 0));
  EXPECT_TRUE(told.back().second);
  release(at({0, 0, 0}) + QPoint(31, 0));
  EXPECT_FALSE(told.back().second);
}

TEST_F(PreviewViewLampsTest, AnotherButtonLeavesALampHeld) {
  QSignalSpy camera(&view, &PreviewView::cameraChanged);
  const QPoint start = at({0, 0, 0}), end = start + QPoint(60, 0);
  press(start);
  QTest::mousePress(&view, Qt::RightButton, {}, start);
  move(end, Qt::LeftButton | Qt::RightButton);
  QTest::mouseRelease(&view, Qt::RightButton, {}, end);
  EXPECT_TRUE(told.back().second) << "still held";
  const Vec3 expected = 60 * projection.mm_per_px({0, 0, 0}) * projection.right();
  EXPECT_LT((place(0) - expected).norm(), 1e-6);
  QTest::mousePress(&view, Qt::RightButton, {}, end);
  release(end);
  EXPECT_FALSE(told.back().second);
  move(start, Qt::RightButton);
  QTest::mouseRelease(&view, Qt::RightButton, {}, start);
  EXPECT_LT((place(0) - expected).norm(), 1e-6) << "let go";
  EXPECT_EQ(camera.count(), 0) << "that press began nothing";
}

TEST_F(PreviewViewLampsTest, WithShiftItMovesAlongItsBeam) {
  press(at({0, 0, 0}), Qt::ShiftModifier);
  move(at({0, 0, 0}) + QPoint(40, 25));
  release(at({0, 0, 0}) + QPoint(40, 25));
  EXPECT_NEAR(place(0).x(), 40 * projection.mm_per_px({0, 0, 0}), half_px_mm);
  EXPECT_LT(place(0).tail<2>().norm(), 1e-9);
  // The other's beam leads away from the eye.
  press(at({200, 0, 0}), Qt::ShiftModifier);
  move(at({200, 0, 0}) + QPoint(0, -12));
  release(at({200, 0, 0}) + QPoint(0, -12));
  EXPECT_GT(place(1).y(), 20);
  EXPECT_LT((place(1) - Vec3(200, place(1).y(), 0)).norm(), 1e-9);
}

TEST_F(PreviewViewLampsTest, ByItsTipOrWithCtrlItTurns) {
  const double length = arrow_px * projection.mm_per_px({0, 0, 0});
  const QPoint tip = at({length, 0, 0});
  press(tip);
  move(tip + QPoint(-20, -30));
  release(tip + QPoint(-20, -30));
  const Vec2 shown = *projection.to_px(length * beam_of(pose(0)));
  EXPECT_LT((shown - Vec2(tip.x() - 20, tip.y() - 30)).norm(), 1);
  EXPECT_GT(angles(0).pitch_deg, 10);
  EXPECT_NEAR(angles(0).roll_deg, 0, 1e-6) << "level";
  EXPECT_LT(place(0).norm(), 1e-9);

  const double yaw = angles(1).yaw_deg;
  press(at({200, 0, 0}), Qt::ControlModifier);
  move(at({200, 0, 0}) + QPoint(20, 0));
  release(at({200, 0, 0}) + QPoint(20, 0));
  EXPECT_LT(angles(1).yaw_deg, yaw - 10) << "to the right of who looks along it";
  EXPECT_LT((place(1) - Vec3(200, 0, 0)).norm(), 1e-9);
}

TEST_F(PreviewViewLampsTest, EscPutsItBackAndTheRestOfTheDragDoesNothing) {
  press(at({0, 0, 0}));
  move(at({0, 0, 0}) + QPoint(60, 10));
  EXPECT_GT(place(0).norm(), 100);
  QTest::keyClick(&view, Qt::Key_Escape);
  EXPECT_EQ(pose(0), lamps[0].pose);
  ASSERT_FALSE(told.empty());
  EXPECT_FALSE(told.back().second);
  const std::size_t before = told.size();
  move(at({0, 0, 0}) + QPoint(90, 10));
  release(at({0, 0, 0}) + QPoint(90, 10));
  EXPECT_EQ(told.size(), before);
  EXPECT_EQ(view.lamps().chosen(), 0);
  QTest::keyClick(&view, Qt::Key_Escape);
  EXPECT_EQ(view.lamps().chosen(), -1);
}

TEST_F(PreviewViewLampsTest, AClickChoosesAndOneBesideChoosesNone) {
  QSignalSpy camera(&view, &PreviewView::cameraChanged);
  press(at({200, 0, 0}));
  move(at({200, 0, 0}) + QPoint(2, 1));  // a hand is not quite still
  release(at({200, 0, 0}) + QPoint(2, 1));
  EXPECT_EQ(view.lamps().chosen(), 1);
  EXPECT_TRUE(told.empty());
  EXPECT_TRUE(said().contains("Lamp 2 at 200, 0, 0 mm · yaw 90° · pitch 0° · roll 0° · scale 0.5"))
      << said().toStdString();
  press({50, 50});
  move({80, 50});
  release({80, 50});
  EXPECT_EQ(camera.count(), 1) << "beside a lamp the camera orbits";
  EXPECT_EQ(view.lamps().chosen(), 1) << "and the choice stays";
  press({50, 50});
  release({50, 50});
  EXPECT_EQ(view.lamps().chosen(), -1);
  QTest::mouseDClick(&view, Qt::LeftButton, {}, at({200, 0, 0}));
  EXPECT_EQ(camera.count(), 1) << "a double click on a lamp is no way back to the scene's camera";
  release(at({200, 0, 0}));
}

TEST_F(PreviewViewLampsTest, KeysMoveAndTurnTheChosenLamp) {
  QSignalSpy camera(&view, &PreviewView::cameraChanged);
  QTest::keyClick(&view, Qt::Key_Right);
  EXPECT_EQ(camera.count(), 1) << "none is chosen";
  QTest::keyClick(&view, Qt::Key_L);
  EXPECT_EQ(view.lamps().chosen(), 0);
  QTest::keyClick(&view, Qt::Key_L);
  EXPECT_EQ(view.lamps().chosen(), 1);
  QTest::keyClick(&view, Qt::Key_L);
  EXPECT_EQ(view.lamps().chosen(), 0);
  QTest::keyClick(&view, Qt::Key_L, Qt::ShiftModifier);
  EXPECT_EQ(view.lamps().chosen(), 1);

  QTest::keyClick(&view, Qt::Key_Right);
  EXPECT_LT((place(1) - Vec3(200, 0, 0) - 10 * projection.right()).norm(), 1e-9);
  QTest::keyClick(&view, Qt::Key_Down);
  EXPECT_LT((place(1) - Vec3(200, 0, 0) - 10 * projection.right() + 10 * projection.up()).norm(), 1e-9);
  const Vec3 before = place(1);
  QTest::keyClick(&view, Qt::Key_Up, Qt::ShiftModifier);
  EXPECT_LT((place(1) - before - Vec3(0, 10, 0)).norm(), 1e-9) << "along its beam";
  QTest::keyClick(&view, Qt::Key_Left, Qt::ControlModifier);
  QTest::keyClick(&view, Qt::Key_Up, Qt::ControlModifier);
  EXPECT_NEAR(angles(1).yaw_deg, 91, 1e-9);
  EXPECT_NEAR(angles(1).pitch_deg, 1, 1e-9);
  EXPECT_TRUE(told.back().second);
  ASSERT_TRUE(QTest::qWaitFor([&] { return !told.back().second; }));
  EXPECT_EQ(told.back().first[1].pose, pose(1));
  EXPECT_EQ(told.back().first[1].scale, 0.5);

  QTest::keyClick(&view, Qt::Key_Escape);
  QTest::keyClick(&view, Qt::Key_Right);
  EXPECT_GT(camera.count(), 1) << "the keys are the camera's again";
}

TEST_F(PreviewViewLampsTest, SaysWhatCanBeDoneWhereTheCursorIs) {
  QSignalSpy pointed(&view, &PreviewView::pointed);
  const auto last = [&] { return pointed.last().at(0).toString(); };
  move(at({0, 0, 0}), Qt::NoButton);
  EXPECT_TRUE(last().contains("Lamp 1: drag to move it, with Shift along its beam, with Ctrl to turn it"));
  EXPECT_EQ(view.cursor().shape(), Qt::OpenHandCursor);
  QHelpEvent help(QEvent::ToolTip, at({0, 0, 0}), view.mapToGlobal(at({0, 0, 0})));
  QApplication::sendEvent(&view, &help);
  EXPECT_TRUE(QToolTip::text().contains("Esc cancels")) << QToolTip::text().toStdString();
  move(at({arrow_px * projection.mm_per_px({0, 0, 0}), 0, 0}), Qt::NoButton);
  EXPECT_TRUE(last().contains("the tip"));
  press(at({0, 0, 0}));
  move(at({0, 0, 0}) + QPoint(0, 30));
  EXPECT_TRUE(last().contains("Lamp 1 at")) << last().toStdString();
  release(at({0, 0, 0}) + QPoint(0, 30));
  move({50, 50}, Qt::NoButton);
  EXPECT_TRUE(last().contains("pixel 50, 50"));
  EXPECT_EQ(view.cursor().shape(), Qt::CrossCursor);
}

TEST_F(PreviewViewLampsTest, HandlesAreDrawnAndTheChosenOneStandsOut) {
  const auto colours = [&] {
    const QImage image = view.grab().toImage();
    int plain = 0, chosen = 0;
    for (int y = 0; y < image.height(); ++y)
      for (int x = 0; x < image.width(); ++x) {
        const QColor c = image.pixelColor(x, y);
        if (c == QColor(235, 235, 235)) ++plain;
        if (c == QColor(255, 170, 40)) ++chosen;
      }
    return std::pair(plain, chosen);
  };
  const auto none = colours();
  EXPECT_GT(none.first, 100);
  EXPECT_EQ(none.second, 0);
  view.lamps().choose(1);
  EXPECT_GT(colours().second, 50);
  view.lamps().set_scene({}, {0, 0, 1});
  EXPECT_LT(colours().first, 20);
}

TEST_F(PreviewViewLampsTest, AnotherSceneLetsGoOfWhatIsHeld) {
  press(at({0, 0, 0}));
  move(at({0, 0, 0}) + QPoint(30, 0));
  ASSERT_EQ(told.size(), 1u);
  view.set_scene(preview_camera(), {lamps[1]});
  move(at({0, 0, 0}) + QPoint(60, 0));
  release(at({0, 0, 0}) + QPoint(60, 0));
  QTest::qWait(2 * LampArrangement::rest_ms);
  EXPECT_EQ(told.size(), 1u);
  ASSERT_EQ(view.lamps().count(), 1);
  EXPECT_EQ(pose(0), lamps[1].pose);
  EXPECT_EQ(view.lamps().chosen(), -1);
}

}  // namespace
}  // namespace lumifield
