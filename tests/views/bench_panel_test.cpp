#include "app/views/bench_panel.h"

#include <QComboBox>
#include <QLabel>
#include <QSignalSpy>
#include <QTest>
#include <gtest/gtest.h>

#include "app/views/device_line.h"
#include "app/views/histogram_view.h"
#include "app/views/image_view.h"
#include "app/views/stage_map.h"

namespace lumifield {
namespace {

/// 8 × 6, every photosite `dn`.
RawImage frame(double exposure_s, std::uint16_t dn, SensorPattern pattern = SensorPattern::mono) {
  RawImage raw;
  raw.width_px = 8;
  raw.height_px = 6;
  raw.pattern = pattern;
  raw.exposure_s = exposure_s;
  raw.dn.assign(48, dn);
  return raw;
}

std::shared_ptr<const Bracket> bracket(std::uint16_t dn, SensorPattern pattern = SensorPattern::mono) {
  return std::make_shared<const Bracket>(Bracket{frame(0.002, static_cast<std::uint16_t>(dn / 4), pattern),
                                                 frame(0.128, dn, pattern), frame(1.5, 4095, pattern)});
}

template <class Widget = QLabel>
Widget* named(QWidget& panel, const QString& name) {
  for (Widget* one : panel.findChildren<Widget*>())
    if (one->accessibleName() == name) return one;
  return nullptr;
}

/// A visible panel that looks into a view.
struct Shown {
  std::shared_ptr<BenchView> view = std::make_shared<BenchView>();
  BenchPanel panel;
  QSignalSpy pictures{&panel, &BenchPanel::pictureShown};

  Shown() {
    panel.set_view(view);
    panel.set_saturation(4000);
    panel.resize(400, 620);
    panel.show();
  }
  void choose(const QString& box, int item) {
    auto* combo = named<QComboBox>(panel, box);
    combo->setFocus();
    QTest::keyClick(combo, Qt::Key_Home);
    for (int k = 0; k < item; ++k) QTest::keyClick(combo, Qt::Key_Down);
  }
};

TEST(BenchPanel, HasItsViewWatchedWhileItIsVisible) {
  Shown s;
  EXPECT_TRUE(s.view->watched());
  s.panel.hide();
  EXPECT_FALSE(s.view->watched());
  s.panel.show();
  EXPECT_TRUE(s.view->watched());
  const auto other = std::make_shared<BenchView>();
  s.panel.set_view(other);
  EXPECT_FALSE(s.view->watched());
  EXPECT_TRUE(other->watched());
}

TEST(BenchPanel, ShowsTheLongestExposureThenTheChosen) {
  Shown s;
  s.view->set_bracket(bracket(1000), "cell (3, 4), pass positive");
  ASSERT_TRUE(s.pictures.wait());
  EXPECT_EQ(s.panel.picture()->raw().exposure_s, 1.5);
  EXPECT_EQ(named(s.panel, "Place of the picture")->text(), "last picture: cell (3, 4), pass positive");
  s.view->set_camera({DeviceView::Link::open, "Acme C1", ""});
  EXPECT_TRUE(
      QTest::qWaitFor([&] { return named(s.panel, "Place of the picture")->text() == "cell (3, 4), pass positive"; }));
  EXPECT_EQ(named(s.panel, "Over-exposed pixels")->text(), "over-exposed: 100 %");
  const auto* box = named<QComboBox>(s.panel, "Exposure shown");
  EXPECT_EQ(box->currentText(), "1.5 s (longest)");
  EXPECT_EQ(box->itemText(0), "2 ms");

  s.choose("Exposure shown", 1);
  EXPECT_TRUE(QTest::qWaitFor([&] { return s.panel.picture()->raw().exposure_s == 0.128; }));
  EXPECT_EQ(named(s.panel, "Over-exposed pixels")->text(), "over-exposed: 0 %");
  s.view->set_bracket(bracket(2000), "cell (3, 5), pass positive");
  EXPECT_TRUE(QTest::qWaitFor([&] { return s.panel.picture()->raw().dn[0] == 2000; }));
}

TEST(BenchPanel, LooksOnlyWhileItIsVisible) {
  Shown s;
  s.panel.hide();
  s.view->set_bracket(bracket(1000), "live");
  EXPECT_FALSE(s.pictures.wait(500));
  s.panel.show();
  EXPECT_TRUE(s.pictures.wait());
  EXPECT_FALSE(s.pictures.wait(500));  // nothing changed
}

TEST(BenchPanel, TellsThePixelUnderTheCursor) {
  Shown s;
  auto raws = *bracket(1000, SensorPattern::rggb);
  raws.back().dn[2 * 8 + 5] = 1234;  // column 5, row 2: G
  s.view->set_bracket(std::make_shared<const Bracket>(raws), "live");
  ASSERT_TRUE(s.pictures.wait());
  auto* image = s.panel.findChild<ImageView*>();
  const QLabel* pixel = named(s.panel, "Pixel under the cursor");
  const auto hover = [&](double column, double row) {
    const QRectF area = image->image_rect();
    const QSizeF size = image->image().size();
    QTest::mouseMove(image, (area.topLeft() + QPointF(area.width() * (column + 0.5) / size.width(),
                                                      area.height() * (row + 0.5) / size.height()))
                                .toPoint());
  };
  hover(5, 2);
  EXPECT_TRUE(QTest::qWaitFor([&] { return pixel->text() == "column 5, row 2: 1234 DN G"; }))
      << pixel->text().toStdString();
  s.choose("Colours shown", 1);
  EXPECT_TRUE(QTest::qWaitFor([&] { return s.panel.picture()->step == 2; }));
  hover(2, 1);
  EXPECT_TRUE(QTest::qWaitFor([&] { return pixel->text() == "column 4, row 2: R 4095, G 2664, B 4095 DN"; }))
      << pixel->text().toStdString();
}

TEST(BenchPanel, TellsHowTheDevicesAreConnectedAndWhereTheStageStands) {
  Shown s;
  s.panel.set_limits({{-40, -40}, {130, 120}});
  s.view->set_camera({DeviceView::Link::open, "Acme C1, 10.0.0.2", ""});
  s.view->set_stage({DeviceView::Link::failed, "", "/dev/ttyUSB0: no <answer>; check the cable"});
  s.view->set_stage_mm({12.5, -3.25});
  const auto says = [&](const QString& text) { return named<DeviceLine>(s.panel, text) != nullptr; };
  EXPECT_TRUE(QTest::qWaitFor([&] { return says("Camera: Acme C1, 10.0.0.2"); }));
  EXPECT_TRUE(says("Stage: failed: /dev/ttyUSB0: no <answer>; check the cable"));
  EXPECT_EQ(named(s.panel, "Stage's position")->text(), "x 12.500 mm\ny −3.250 mm");
  s.view->set_stage({DeviceView::Link::opening, "", ""});
  s.view->set_stage_mm({140, 0});
  EXPECT_TRUE(QTest::qWaitFor([&] { return says("Stage: opening…"); }));
  EXPECT_TRUE(s.panel.findChild<StageMap*>()->outside());
}

TEST(StageMap, HasXToTheRightAndYUpwardsAtOneScale) {
  StageMap map;
  map.resize(220, 110);
  map.set_limits({{-10, -20}, {90, 80}});
  const QPointF low = map.point_of({-10, -20}), high = map.point_of({90, 80});
  EXPECT_LT(low.x(), high.x());
  EXPECT_GT(low.y(), high.y());
  EXPECT_NEAR(high.x() - low.x(), low.y() - high.y(), 1e-9);
  EXPECT_TRUE(QRectF(map.rect()).contains(low));
  map.set_position(Vec2(90, 80));
  EXPECT_FALSE(map.outside());
  map.set_position(Vec2(90.001, 80));
  EXPECT_TRUE(map.outside());
}

}  // namespace
}  // namespace lumifield
