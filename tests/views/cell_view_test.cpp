#include "app/views/cell_view.h"

#include <QCheckBox>
#include <QComboBox>
#include <QCursor>
#include <QLabel>
#include <QTest>
#include <gtest/gtest.h>

#include "app/views/colour_bar.h"
#include "app/views/image_view.h"
#include "tests/views/lamp_model.h"

namespace lumifield {
namespace {

struct CellViewTest : testing::Test {
  void SetUp() override {
    view.resize(400, 720);
    view.show();
    ASSERT_TRUE(QTest::qWaitForWindowExposed(&view));
  }
  void begin(std::vector<std::string> channels = {"Y"}) {
    geometry = lamp_geometry(3, 1, std::move(channels));
    model.reset(geometry, "lamp");
  }
  /// Pixel (i, j) of S as shown.
  QRgb shown(int i, int j) { return image().image().pixel(i, geometry.measurement.height_px - 1 - j); }
  /// Puts the pointer on the middle of pixel (i, j) of S and waits until the display's event has come.
  void point_at(int i, int j) {
    const QPoint pixel(i, geometry.measurement.height_px - 1 - j);
    EXPECT_TRUE(QTest::qWaitFor([&] {
      const QRectF whole = image().image_rect();  // it is laid out meanwhile
      const QPointF at =
          whole.topLeft() + QPointF(whole.width() / 8 * (pixel.x() + 0.5), whole.height() / 6 * (pixel.y() + 0.5));
      QCursor::setPos(image().mapToGlobal(at.toPoint() + QPoint(1, 0)));
      QCursor::setPos(image().mapToGlobal(at.toPoint()));
      return image().hovered_pixel() == pixel;
    }));
  }
  /// Everything that its labels say at this moment.
  QString said() {
    QStringList all;
    for (const QLabel* label : view.findChildren<QLabel*>())
      if (label->isVisible()) all << label->text();
    return all.join(u'|');
  }
  QComboBox& choice(const QString& name) {
    for (QComboBox* box : view.findChildren<QComboBox*>())
      if (box->accessibleName() == name) return *box;
    throw std::runtime_error("no such choice");
  }
  void choose(const QString& name, Qt::Key key) {
    choice(name).setFocus();
    QTest::keyClick(&choice(name), key);
  }
  ImageView& image() { return *view.findChild<ImageView*>(); }
  ColourBar& bar() { return *view.findChild<ColourBar*>(); }
  HistogramView& histogram() { return *view.findChild<HistogramView*>(); }

  LuminaireModel model;
  LuminaireGeometry geometry;
  CellView view{model};
};

TEST_F(CellViewTest, SaysWhyThereIsNothingToShow) {
  EXPECT_TRUE(said().contains("No cell chosen"));
  begin();
  view.show_cell({0, 9});
  EXPECT_EQ(view.cell(), std::nullopt);
  view.show_cell({0, 1});
  EXPECT_TRUE(said().contains("Cell (row 0, column 1): unmeasured")) << said().toStdString();
  EXPECT_TRUE(image().image().isNull());
  EXPECT_FALSE(bar().isVisible());
  model.set_measuring(CellIndex{0, 1});
  EXPECT_TRUE(said().contains("measuring now"));
}

TEST_F(CellViewTest, FollowsItsCellAsItIsMeasuredAndTakenAgain) {
  begin();
  view.show_cell({0, 1});
  model.put(entry_of({0, 1}), flat_image(geometry, 2));
  EXPECT_EQ(image().image().size(), QSize(8, 6));
  EXPECT_TRUE(bar().isVisible());
  EXPECT_EQ(bar().scale(), (ValueScale{0, 2}));
  EXPECT_TRUE(bar().accessibleDescription().contains("cd/m² per mm²"));
  EXPECT_TRUE(said().contains("No warnings"));
  CellEntry again = entry_of({0, 1}, warned());
  again.generation = 2;
  model.put(again, flat_image(geometry, 5));
  EXPECT_EQ(bar().scale(), (ValueScale{0, 5}));
  EXPECT_TRUE(said().contains("generation 2: measured, warned"));
  EXPECT_TRUE(said().contains("Warning: saturated share 25 % above 0.1 %"));
  EXPECT_TRUE(said().contains("Saturated share|25 %")) << said().toStdString();
  EXPECT_TRUE(said().contains("Total light|60 cd/m²"));
  begin();
  EXPECT_EQ(view.cell(), std::nullopt);
  EXPECT_TRUE(image().image().isNull());
}

TEST_F(CellViewTest, ReadsTheValueUnderTheCursorWithItsPlaceOnS) {
  begin();
  auto ramp = flat_image(geometry, 0);
  for (int j = 0; j < 6; ++j)
    for (int i = 0; i < 8; ++i) ramp->value[static_cast<std::size_t>(8 * j + i)] = static_cast<float>(10 * j + i) / 10;
  ramp->value[8 * 4 + 2] = -0.5F;
  model.put(entry_of({0, 0}), ramp);
  view.show_cell({0, 0});
  point_at(7, 0);
  EXPECT_TRUE(said().contains("Y 0.7 cd/m² per mm²\nat (11.75, −1.25) mm on S, pixel (7, 0)")) << said().toStdString();
  point_at(2, 4);
  EXPECT_TRUE(said().contains("Y −0.5 cd/m² per mm²\nat (9.25, 0.75) mm on S, pixel (2, 4)")) << said().toStdString();
  model.put(entry_of({0, 0}), flat_image(geometry, 3));
  EXPECT_TRUE(said().contains("Y 3 cd/m² per mm²\nat (9.25, 0.75)"));  // the cursor rests, the cell was taken again
  QEvent leave(QEvent::Leave);
  QApplication::sendEvent(&image(), &leave);
  EXPECT_TRUE(said().contains("Point at the image"));
}

TEST_F(CellViewTest, PlusYIsUpAndColoursAreTheScales) {
  begin();
  auto one = flat_image(geometry, 0);
  one->value[8 * 5 + 1] = 4;
  one->value[0] = 2;
  model.put(entry_of({0, 0}), one);
  view.show_cell({0, 0});
  EXPECT_EQ(image().image().pixel(1, 0), colour_of({0, 4}, 4));
  EXPECT_EQ(image().image().pixel(0, 5), colour_of({0, 4}, 2));
  choose("Colours", Qt::Key_Down);
  EXPECT_EQ(shown(1, 5), qRgb(255, 255, 255));
  EXPECT_EQ(shown(0, 0), qRgb(128, 128, 128));
  EXPECT_TRUE(bar().scale().grey);
}

TEST_F(CellViewTest, TheScaleEndsAtTheOwnOrTheCommonMaximumOrIsLogarithmic) {
  begin();
  model.put(entry_of({0, 0}), flat_image(geometry, 2));
  model.put(entry_of({0, 2}), flat_image(geometry, 8));
  view.show_cell({0, 0});
  choose("Scale", Qt::Key_Down);
  EXPECT_EQ(bar().scale(), (ValueScale{0, 8}));
  EXPECT_EQ(shown(3, 3), colour_of({0, 8}, 2));
  model.put(entry_of({0, 1}), flat_image(geometry, 16));  // another cell moves it
  EXPECT_TRUE(QTest::qWaitFor([&] { return bar().scale() == ValueScale{0, 16}; }));
  EXPECT_EQ(shown(3, 3), colour_of({0, 16}, 2));
  choose("Scale", Qt::Key_Down);
  EXPECT_EQ(bar().scale(), (ValueScale{2e-4, 2, true}));
}

TEST_F(CellViewTest, ThreeChannelsAreChosenFrom) {
  begin();
  EXPECT_FALSE(choice("Channel").isVisible());
  begin({"R", "G", "B"});
  EXPECT_TRUE(choice("Channel").isVisible());
  auto faint = flat_image(geometry, 1);
  faint->value[2 * 48] = 30;
  model.put(entry_of({0, 0}), faint);
  view.show_cell({0, 0});
  choose("Channel", Qt::Key_End);
  EXPECT_EQ(view.look().channel, 2);
  EXPECT_EQ(bar().scale(), (ValueScale{0, 30}));
  EXPECT_EQ(shown(0, 0), colour_of({0, 30}, 30));
  EXPECT_EQ(histogram().histogram().counts.back(), 1U);
  point_at(5, 5);
  EXPECT_TRUE(said().contains("R 1  G 2  B 3 cd/m²"));
}

TEST_F(CellViewTest, TheHistogramCountsEveryPixelAndItsBoxIsItsKey) {
  begin();
  auto both = flat_image(geometry, 1);
  both->value[7] = -1;
  model.put(entry_of({0, 0}), both);
  view.show_cell({0, 0});
  const Histogram& h = histogram().histogram();
  EXPECT_EQ(h.from, -1);
  EXPECT_EQ(h.to, 1);
  EXPECT_EQ(h.counts.front(), 1U);
  EXPECT_EQ(h.counts.back(), 47U);
  EXPECT_EQ(h.unit, "cd/m² per mm²");
  auto* box = view.findChild<QCheckBox*>();
  QTest::mouseClick(box, Qt::LeftButton, {}, QPoint(8, box->height() / 2));
  EXPECT_TRUE(histogram().logarithmic());
  QTest::keyClick(&histogram(), Qt::Key_L);
  EXPECT_FALSE(box->isChecked());
}

TEST_F(CellViewTest, NeitherBlackNorMissingQualityIsHidden) {
  begin();
  CellEntry entry = entry_of({0, 0});
  entry.quality.reset();
  model.put(entry, flat_image(geometry, 0));
  view.show_cell({0, 0});
  EXPECT_EQ(bar().scale(), (ValueScale{0, 1}));
  EXPECT_TRUE(said().contains("No quality figures on record"));
  EXPECT_TRUE(said().contains("Median SNR|not known"));
  EXPECT_EQ(shown(0, 0), colour_of({0, 1}, 0));
}

}  // namespace
}  // namespace lumifield
