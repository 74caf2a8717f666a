#include "app/views/preview_view.h"

#include <QImage>
#include <QSignalSpy>
#include <QTest>
#include <QWheelEvent>
#include <cmath>
#include <gtest/gtest.h>

#include "app/views/preview_paint.h"
#include "tests/views/preview_frames.h"

namespace lumifield {
namespace {

/// A view of 400 × 300 on the screen, with scene, luminaire and frame.
class PreviewViewTest : public testing::Test {
 protected:
  PreviewViewTest() {
    view.resize(400, 300);
    view.set_scene(preview_camera());
    view.set_luminaire(preview_luminaire());
    view.show();
    EXPECT_TRUE(QTest::qWaitForWindowExposed(&view));
    view.activateWindow();
    view.setFocus();
    QTest::qWait(2 * PreviewView::rest_ms);
  }
  void show(PreviewFrame frame) { view.show_frame(std::make_shared<const PreviewFrame>(std::move(frame))); }
  void drag(Qt::MouseButton button, Qt::KeyboardModifiers keys, QPoint from, QPoint to) {
    QTest::mousePress(&view, button, keys, from);
    QMouseEvent move(QEvent::MouseMove, to, view.mapToGlobal(to), Qt::NoButton, button, keys);
    QApplication::sendEvent(&view, &move);
    QTest::mouseRelease(&view, button, keys, to);
  }
  void wheel(double steps, QPointF at) {
    QWheelEvent event(at, view.mapToGlobal(at), {}, QPoint(0, static_cast<int>(120 * steps)), Qt::NoButton,
                      Qt::NoModifier, Qt::NoScrollPhase, false);
    QApplication::sendEvent(&view, &event);
  }
  static double distance(const SceneCamera& a, const SceneCamera& b) { return (a.position_mm - b.position_mm).norm(); }

  PreviewView view;
};

SceneCamera camera_of(const QSignalSpy& spy, int n) { return spy.at(n).at(0).value<SceneCamera>(); }
SceneCamera last_camera(const QSignalSpy& spy) { return spy.last().at(0).value<SceneCamera>(); }
bool moving_of(const QSignalSpy& spy, int n) { return spy.at(n).at(1).toBool(); }

TEST_F(PreviewViewTest, LeftDragOrbitsAndComesToRest) {
  show(preview_frame(400, 300));
  QSignalSpy changed(&view, &PreviewView::cameraChanged);
  drag(Qt::LeftButton, {}, {200, 150}, {250, 160});
  ASSERT_EQ(changed.count(), 1);
  EXPECT_TRUE(moving_of(changed, 0));
  OrbitCamera expected(preview_camera());
  expected.orbit(-50 * PreviewView::orbit_deg_per_px, 10 * PreviewView::orbit_deg_per_px);
  EXPECT_LT(distance(camera_of(changed, 0), expected.camera()), 1e-9);

  ASSERT_TRUE(changed.wait());
  EXPECT_FALSE(moving_of(changed, 1));
  EXPECT_EQ(distance(camera_of(changed, 1), camera_of(changed, 0)), 0);
  EXPECT_FALSE(changed.wait(2 * PreviewView::rest_ms));  // and no more
}

TEST_F(PreviewViewTest, RightMiddleAndShiftDragPanWithTheCursor) {
  show(preview_frame(400, 300));
  OrbitCamera expected(preview_camera());
  expected.pan(30, -20, 300);
  for (const auto& [button, keys] : std::vector<std::pair<Qt::MouseButton, Qt::KeyboardModifiers>>{
           {Qt::RightButton, {}}, {Qt::MiddleButton, {}}, {Qt::LeftButton, Qt::ShiftModifier}}) {
    view.set_scene(preview_camera());
    show(preview_frame(400, 300));
    QSignalSpy changed(&view, &PreviewView::cameraChanged);
    drag(button, keys, {200, 150}, {230, 130});
    ASSERT_EQ(changed.count(), 1);
    EXPECT_LT((camera_of(changed, 0).target_mm - expected.target_mm()).norm(), 1e-9);
  }
}

TEST_F(PreviewViewTest, WheelZoomsAboutTheCursorAndKeysWork) {
  show(preview_frame(400, 300));
  QSignalSpy changed(&view, &PreviewView::cameraChanged);
  wheel(2, {300, 100});
  OrbitCamera expected(preview_camera());
  expected.zoom(2, {100, -50}, 300);
  ASSERT_EQ(changed.count(), 1);
  EXPECT_LT(distance(camera_of(changed, 0), expected.camera()), 1e-9);

  QTest::keyClick(&view, Qt::Key_Right);
  expected.orbit(PreviewView::orbit_deg_per_key, 0);
  QTest::keyClick(&view, Qt::Key_Minus);
  expected.zoom(-1, {0, 0}, 300);
  QTest::keyClick(&view, Qt::Key_Up, Qt::ShiftModifier);
  expected.pan(0, PreviewView::pan_px_per_key, 300);
  ASSERT_EQ(changed.count(), 4);
  EXPECT_LT(distance(camera_of(changed, 3), expected.camera()), 1e-9);

  QTest::keyClick(&view, Qt::Key_R);
  EXPECT_LT(distance(camera_of(changed, 4), preview_camera()), 1e-9);
  wheel(1, {10, 10});
  QTest::mouseDClick(&view, Qt::LeftButton, {}, {200, 150});
  EXPECT_LT(distance(last_camera(changed), preview_camera()), 1e-9);
}

TEST_F(PreviewViewTest, WithoutASceneNothingMoves) {
  PreviewView empty;
  QSignalSpy changed(&empty, &PreviewView::cameraChanged);
  QTest::keyClick(&empty, Qt::Key_Left);
  QTest::mouseDClick(&empty, Qt::LeftButton);
  EXPECT_EQ(changed.count(), 0);
  EXPECT_EQ(empty.accessibleDescription(), "no scene");
}

TEST_F(PreviewViewTest, AsksForItsSizeOnceItRestsAndNeverForMoreThanItsBound) {
  QSignalSpy wanted(&view, &PreviewView::sizeWanted);
  const double ratio = view.devicePixelRatioF();
  view.resize(410, 310);
  view.resize(420, 320);
  ASSERT_TRUE(wanted.wait());
  ASSERT_EQ(wanted.count(), 1);
  EXPECT_EQ(wanted.at(0).at(0).toInt(), static_cast<int>(420 * ratio));
  EXPECT_EQ(wanted.at(0).at(1).toInt(), static_cast<int>(320 * ratio));
  view.resize(2000, 1000);
  ASSERT_TRUE(wanted.wait());
  const int width = wanted.at(1).at(0).toInt(), height = wanted.at(1).at(1).toInt();
  EXPECT_LE(width * height, PreviewView::most_pixels);
  EXPECT_GT(width * height, PreviewView::most_pixels - width - height);
  EXPECT_NEAR(static_cast<double>(width) / height, 2, 0.01);
}

TEST_F(PreviewViewTest, ShowsThePictureScaledWithItsAspect) {
  PreviewFrame frame = preview_frame(40, 20);
  frame.cells = frame.total;
  const QColor left(frame.shown.srgb[0], frame.shown.srgb[1], frame.shown.srgb[2]);
  const std::size_t last = 3 * 39;
  const QColor right(frame.shown.srgb[last], frame.shown.srgb[last + 1], frame.shown.srgb[last + 2]);
  show(frame);
  EXPECT_EQ(view.picture_rect(), QRectF(0, 50, 400, 200));
  const QImage grabbed = view.grab().toImage();
  const auto at = [&](int x, int y) { return grabbed.pixelColor(QPoint(x, y) * view.devicePixelRatioF()); };
  EXPECT_EQ(at(50, 60), left);
  EXPECT_EQ(at(350, 60), right);
  EXPECT_EQ(at(200, 20), view.palette().color(QPalette::Window));
}

TEST_F(PreviewViewTest, ACoarsePictureFillsItsPlaceInSpiteOfRounding) {
  show(preview_frame(43, 32));
  EXPECT_EQ(view.picture_rect(), QRectF(0, 0, 400, 300));
  show(preview_frame(43, 30));
  EXPECT_LT(view.picture_rect().height(), 300);
}

TEST_F(PreviewViewTest, TellsTheFirstPaintOfEachFrame) {
  QSignalSpy painted(&view, &PreviewView::painted);
  show(preview_frame(40, 30));
  ASSERT_TRUE(painted.wait());
  EXPECT_EQ(painted.at(0).at(0).value<std::shared_ptr<const PreviewFrame>>(), view.frame());
  view.repaint();
  EXPECT_EQ(painted.count(), 1);
  show(preview_frame(40, 30));
  view.repaint();
  EXPECT_EQ(painted.count(), 2);
}

TEST_F(PreviewViewTest, TellsTheValueUnderTheCursor) {
  show(preview_frame(40, 30));
  QSignalSpy pointed(&view, &PreviewView::pointed);
  const auto last = [&] { return pointed.last().at(0).toString(); };
  QMouseEvent move(QEvent::MouseMove, QPointF(105.5, 55.5), view.mapToGlobal(QPointF(105.5, 55.5)), Qt::NoButton,
                   Qt::NoButton, Qt::NoModifier);
  QApplication::sendEvent(&view, &move);
  EXPECT_EQ(last(), "pixel 10, 5: Y709 0.2 W/(m² sr)");
  show(preview_frame(40, 30, {0.5F, 0.5F, 0.5F}));  // the cursor rests, the light grows
  EXPECT_EQ(last(), "pixel 10, 5: Y709 0.5 W/(m² sr)");
  PreviewFrame coarse = preview_frame(40, 30);
  coarse.coarse = true;  // its pixels are told by their places in the full picture
  show(coarse);
  const double ratio = view.devicePixelRatioF();
  EXPECT_EQ(last().toStdString(),
            QString("pixel %1, %2: Y709 0.2 W/(m² sr)").arg(int(105.5 * ratio)).arg(int(55.5 * ratio)).toStdString());
  show(preview_frame(40, 30));
  QMouseEvent below(QEvent::MouseMove, QPointF(105, 299), view.mapToGlobal(QPointF(105, 299)), Qt::NoButton,
                    Qt::NoButton, Qt::NoModifier);
  QApplication::sendEvent(&view, &below);
  EXPECT_EQ(last(), "pixel 10, 29: background");
  QEvent leave(QEvent::Leave);
  QApplication::sendEvent(&view, &leave);
  EXPECT_EQ(last(), "");
}

TEST_F(PreviewViewTest, SaysWhatIsMissingAndWhyThereIsNoPicture) {
  const Error error{"no OpenCL device", "OpenCL", "install pocl-opencl-icd", {}};
  view.show_failure(error);
  EXPECT_TRUE(view.picture_rect().isEmpty());
  EXPECT_EQ(view.accessibleDescription(), "OpenCL: no OpenCL device; install pocl-opencl-icd");
  show(preview_frame(40, 30));
  EXPECT_EQ(view.accessibleDescription(), "37 of 63 cells; 26 of 63 cells not measured yet: their light is missing");
  view.show_failure(error);  // of one cell, say: the picture stays true
  EXPECT_FALSE(view.picture_rect().isEmpty());
  EXPECT_TRUE(view.accessibleDescription().startsWith("OpenCL: no OpenCL device; install pocl-opencl-icd; 37 of 63"));
  show(preview_frame(40, 30));
  EXPECT_FALSE(view.picture_rect().isEmpty());
  view.set_scene(preview_camera());  // the old scene's picture does not stay
  EXPECT_TRUE(view.picture_rect().isEmpty());
}

TEST_F(PreviewViewTest, SaysAtOnceWhatIsComputedAndThatCellsWait) {
  show(preview_frame(40, 30));
  view.set_cells({40, 0});
  EXPECT_TRUE(view.accessibleDescription().endsWith("3 measured cells are not in the picture yet"));
  const QImage before = view.grab().toImage();
  view.set_chosen({{.method = Method::far_field}});
  EXPECT_TRUE(view.accessibleDescription().contains("Computing far-field · shadows: tile. Shown: closed-form"));
  EXPECT_NE(view.grab().toImage(), before) << "on the picture too";

  // Refused, it is told once, and as long as it is chosen: frames by the former method come meanwhile.
  PreviewProgress refused;
  refused.asked.method = Method::far_field;
  refused.refused = Error{"no memory", "far-field", "close other programs", {}};
  view.show_progress(refused);
  view.show_failure(*refused.refused);
  show(preview_frame(40, 30));
  EXPECT_EQ(view.accessibleDescription().count("no memory"), 1);
  EXPECT_TRUE(view.accessibleDescription().contains("No picture by far-field"));
  view.set_chosen({});
  EXPECT_FALSE(view.accessibleDescription().contains("far-field"));
}

TEST_F(PreviewViewTest, FalseColourBringsItsScale) {
  PreviewFrame frame = preview_frame(400, 300, {0, 0, 0}, {0, 0, 0});
  frame.scale_top = 0.8;
  show(frame);
  const QImage plain = view.grab().toImage();
  frame.look.false_colour = true;
  show(frame);
  const QImage scaled = view.grab().toImage();
  int colours = 0;  // of the bar, along the column where it stands
  for (int x = 300 * scaled.width() / 400; x < 396 * scaled.width() / 400; ++x) {
    std::set<QRgb> seen;
    for (int y = 0; y < 2 * scaled.height() / 3; ++y) seen.insert(scaled.pixel(x, y));
    colours = std::max(colours, static_cast<int>(seen.size()));
    EXPECT_EQ(plain.pixelColor(x, 100).lightness(), 0);
  }
  EXPECT_GT(colours, 100);
}

}  // namespace
}  // namespace lumifield
