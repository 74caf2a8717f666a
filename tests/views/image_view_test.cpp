#include "app/views/image_view.h"

#include <QCursor>
#include <QSignalSpy>
#include <QTest>
#include <QWheelEvent>
#include <gtest/gtest.h>

#include "app/views/mask_reduction.h"

namespace lumifield {
namespace {

/// Column in the red, row in the green channel.
QImage coordinates(int width, int height) {
  QImage image(width, height, QImage::Format_RGB32);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) image.setPixel(x, y, qRgb(x, y, 0));
  return image;
}

void wheel(ImageView& view, const QPointF& at, int delta) {
  QWheelEvent event(at, view.mapToGlobal(at), {}, {0, delta}, Qt::NoButton, Qt::NoModifier, Qt::NoScrollPhase, false);
  QApplication::sendEvent(&view, &event);
}

struct ImageViewTest : testing::Test {
  void SetUp() override {
    view.resize(400, 200);
    view.show();
    ASSERT_TRUE(QTest::qWaitForWindowExposed(&view));
    view.set_image(coordinates(100, 100));
  }
  QRgb colour_at(QPoint position) { return view.grab().toImage().pixel(position * view.devicePixelRatio()); }
  ImageView view;
};

TEST_F(ImageViewTest, FitsInTheMiddleAndStaysFittedWhenResized) {
  EXPECT_EQ(view.image_rect(), QRectF(100, 0, 200, 200));
  view.resize(100, 300);
  EXPECT_EQ(view.image_rect(), QRectF(0, 100, 100, 100));
  view.set_pixel_aspect(2);
  EXPECT_EQ(view.image_rect(), QRectF(0, 50, 100, 200));
}

TEST_F(ImageViewTest, TheWheelZoomsAboutTheCursor) {
  const QPointF at(150.5, 60.5);
  const auto before = view.pixel_at(at);
  for (int k = 0; k < 12; ++k) wheel(view, at, 120);
  EXPECT_NEAR(view.zoom(), 2 * std::pow(1.25, 12), 1e-9);
  EXPECT_EQ(view.pixel_at(at), before);
  EXPECT_EQ(*before, QPoint(25, 30));
  for (int k = 0; k < 40; ++k) wheel(view, at, -120);
  EXPECT_EQ(view.zoom(), 1);  // an image smaller than the view shrinks to its own size, not below
}

TEST_F(ImageViewTest, EnlargedPixelsAreSharpSquares) {
  for (int k = 0; k < 10; ++k) QTest::keyClick(&view, Qt::Key_Plus);
  const double size = view.zoom();
  ASSERT_GT(size, 10);
  const QRectF whole = view.image_rect();
  const QPoint inside = (whole.topLeft() + QPointF(50.5 * size, 47.5 * size)).toPoint();
  for (const QPoint step : {QPoint(0, 0), QPoint(-6, -6), QPoint(6, 6)}) {
    EXPECT_EQ(colour_at(inside + step), qRgb(50, 47, 0)) << step.x();
  }
  EXPECT_EQ(view.pixel_at(inside), QPoint(50, 47));
}

TEST_F(ImageViewTest, DraggingMovesAndTheImageCannotLeaveTheView) {
  for (int k = 0; k < 6; ++k) QTest::keyClick(&view, Qt::Key_Plus);
  const QRectF before = view.image_rect();
  QTest::mousePress(&view, Qt::LeftButton, {}, {200, 100});
  QTest::mouseMove(&view, {230, 80});
  EXPECT_EQ(view.image_rect().topLeft() - before.topLeft(), QPointF(30, -20));
  QTest::mouseMove(&view, {5000, 5000});
  EXPECT_EQ(view.image_rect().topLeft(), QPointF(200, 100));  // its corner in the view's middle
  QTest::mouseRelease(&view, Qt::LeftButton, {}, {5000, 5000});
  QTest::mouseMove(&view, {100, 100});
  EXPECT_EQ(view.image_rect().topLeft(), QPointF(200, 100));  // its corner in the view's middle
}

TEST_F(ImageViewTest, KeysZoomMoveAndFit) {
  const double fitted = view.zoom();
  for (int k = 0; k < 8; ++k) QTest::keyClick(&view, Qt::Key_Equal);
  QTest::keyClick(&view, Qt::Key_Minus);
  EXPECT_NEAR(view.zoom(), fitted * std::pow(1.25, 7), 1e-9);
  const QPointF before = view.image_rect().topLeft();
  QTest::keyClick(&view, Qt::Key_Right);
  QTest::keyClick(&view, Qt::Key_Up);
  EXPECT_NEAR(view.image_rect().left(), before.x() - 50, 1e-9);
  EXPECT_NEAR(view.image_rect().top(), before.y() + 25, 1e-9);
  QTest::keyClick(&view, Qt::Key_Left);
  QTest::keyClick(&view, Qt::Key_Down);
  EXPECT_NEAR(view.image_rect().left(), before.x(), 1e-9);
  EXPECT_NEAR(view.image_rect().top(), before.y(), 1e-9);
  EXPECT_FALSE(view.fits());
  QTest::keyClick(&view, Qt::Key_0);
  EXPECT_TRUE(view.fits());
  QTest::keyClick(&view, Qt::Key_Plus);
  QTest::mouseDClick(&view, Qt::LeftButton, {}, {200, 100});
  EXPECT_EQ(view.zoom(), fitted);
}

TEST_F(ImageViewTest, TellsThePixelUnderTheCursorAndThatItLeft) {
  QCursor::setPos(view.mapToGlobal(QPoint(410, 210)));  // beside it
  EXPECT_TRUE(
      QTest::qWaitFor([&] { return QCursor::pos() == view.mapToGlobal(QPoint(410, 210)) && !view.hovered_pixel(); }));
  std::vector<std::optional<QPoint>> seen;
  QObject::connect(&view, &ImageView::hovered, [&](const std::optional<QPoint>& pixel) { seen.push_back(pixel); });
  for (const QPoint to : {QPoint(101, 1), QPoint(299, 199), QPoint(300, 199)}) {
    const std::size_t before = seen.size();
    QCursor::setPos(view.mapToGlobal(to));
    EXPECT_TRUE(QTest::qWaitFor([&] { return seen.size() > before; }));
  }
  const std::vector<std::optional<QPoint>> expected{QPoint(0, 0), QPoint(99, 99), std::nullopt};
  EXPECT_EQ(seen, expected);
}

TEST_F(ImageViewTest, AnImageOfTheSameSizeKeepsThePlaceAnotherFits) {
  QTest::keyClick(&view, Qt::Key_Plus);
  const QRectF before = view.image_rect();
  view.set_image(coordinates(100, 100));
  EXPECT_EQ(view.image_rect(), before);
  view.set_image(coordinates(50, 100));
  EXPECT_TRUE(view.fits());
  EXPECT_EQ(view.image_rect(), QRectF(150, 0, 100, 200));
}

TEST_F(ImageViewTest, ASingleMarkedPixelShowsHoweverSmallTheImage) {
  QImage mask(4000, 2000, QImage::Format_ARGB32);
  mask.fill(Qt::transparent);
  mask.setPixel(2002, 1002, qRgb(255, 0, 0));
  QImage image(4000, 2000, QImage::Format_Grayscale8);
  image.fill(0);
  view.set_image(image, mask);
  EXPECT_EQ(colour_at({200, 100}), qRgb(255, 0, 0));
  EXPECT_EQ(colour_at({202, 100}), qRgb(0, 0, 0));
  view.set_image(image, QImage(3, 3, QImage::Format_ARGB32));
  EXPECT_TRUE(view.mask().isNull());
  EXPECT_EQ(colour_at({200, 100}), qRgb(0, 0, 0));
}

TEST_F(ImageViewTest, WithoutAnImageItSaysSo) {
  view.set_image({});
  const QImage empty = view.grab().toImage();
  view.set_placeholder("No picture yet");
  EXPECT_NE(view.grab().toImage(), empty);
  EXPECT_EQ(view.pixel_at({200, 100}), std::nullopt);
  wheel(view, {200, 100}, 120);
  QTest::keyClick(&view, Qt::Key_Left);
  EXPECT_TRUE(view.fits());
}

TEST(ReduceMask, MarksWhereAnyOfThePixelsIsMarked) {
  QImage mask(10, 4, QImage::Format_ARGB32_Premultiplied);
  mask.fill(Qt::transparent);
  mask.setPixel(9, 3, qRgb(1, 2, 3));
  mask.setPixel(0, 0, qRgb(4, 5, 6));
  const QImage reduced = reduce_mask(mask, {5, 2});
  int marked = 0;
  for (int y = 0; y < 2; ++y)
    for (int x = 0; x < 5; ++x) marked += qAlpha(reduced.pixel(x, y)) > 0;
  EXPECT_EQ(marked, 2);
  EXPECT_EQ(reduced.pixel(4, 1), qRgb(1, 2, 3));
  EXPECT_EQ(reduced.pixel(0, 0), qRgb(4, 5, 6));
}

}  // namespace
}  // namespace lumifield
