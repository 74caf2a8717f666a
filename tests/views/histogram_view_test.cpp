#include "app/views/histogram_view.h"

#include <QSignalSpy>
#include <QTest>
#include <cmath>
#include <gtest/gtest.h>

#include "app/views/value_text.h"

namespace lumifield {
namespace {

Histogram one_peak() {
  Histogram h{std::vector<std::uint64_t>(64, 0), 0, 4096, "signal", "DN", "pixels"};
  h.counts[10] = 10000;
  h.counts[20] = 10;
  return h;
}

struct HistogramViewTest : testing::Test {
  void SetUp() override {
    view.resize(380, 120);
    view.show();
    ASSERT_TRUE(QTest::qWaitForWindowExposed(&view));
    view.set_histogram(one_peak());
  }
  /// Height of the bar over `value`, in pixels.
  int bar(double value) {
    const QImage shown = view.grab().toImage();
    const QRectF plot = view.plot_rect();
    const int x = static_cast<int>((plot.left() + plot.width() * value / 4096) * view.devicePixelRatio());
    int height = 0;
    for (int y = static_cast<int>(plot.top()); y < static_cast<int>(plot.bottom()); ++y)
      height +=
          shown.pixelColor(x, y * static_cast<int>(view.devicePixelRatio())) != view.palette().color(QPalette::Base);
    return height;
  }
  HistogramView view;
};

TEST_F(HistogramViewTest, BarsStandOverTheirValuesAndTheLogarithmShowsRareOnes) {
  const int full = static_cast<int>(view.plot_rect().height());
  EXPECT_GE(full, 36);
  EXPECT_NEAR(bar(10.5 * 64), full, 1);
  EXPECT_LE(bar(20.5 * 64), 3);
  EXPECT_EQ(bar(30.5 * 64), 0);
  QSignalSpy changed(&view, &HistogramView::logarithmicChanged);
  QTest::keyClick(&view, Qt::Key_L);
  EXPECT_EQ(changed.count(), 1);
  EXPECT_NEAR(bar(20.5 * 64), full * 1.3 / 4.3, 2);
  EXPECT_EQ(bar(30.5 * 64), 0);
}

TEST_F(HistogramViewTest, ANarrowBinIsNotLostBetweenPixels) {
  Histogram fine{std::vector<std::uint64_t>(4096, 0), 0, 4096, "signal", "DN", "pixels"};
  fine.counts[2777] = 5;
  view.set_histogram(fine);
  int columns = 0;
  for (int value = 2700; value < 2850; value += 2) columns += bar(value) > 0;
  EXPECT_GT(columns, 0);
}

TEST_F(HistogramViewTest, TellsTheBinUnderTheCursorWithItsUnit) {
  const QRectF plot = view.plot_rect();
  EXPECT_EQ(view.text_at({plot.left() + plot.width() * 10.5 / 64, 50}), "640 … 704 DN: 10000 pixels");
  EXPECT_EQ(view.text_at({plot.left() - 5, 50}), "");
  EXPECT_TRUE(view.accessibleDescription().contains("672 DN"));
}

TEST_F(HistogramViewTest, TheMarkerStandsAtItsValue) {
  const QImage before = view.grab().toImage();
  view.set_marker(4095, "saturated");
  const QImage after = view.grab().toImage();
  const QRectF plot = view.plot_rect();
  const auto changed_in = [&](double from, double to) {
    int changed = 0;
    for (int x = static_cast<int>(from * view.devicePixelRatio()); x < static_cast<int>(to * view.devicePixelRatio());
         ++x)
      for (int y = static_cast<int>(plot.top() * view.devicePixelRatio()); y < plot.bottom() * view.devicePixelRatio();
           ++y)
        changed += before.pixel(x, y) != after.pixel(x, y);
    return changed;
  };
  EXPECT_GT(changed_in(plot.right() - 3, plot.right() + 3), 10);
  EXPECT_EQ(changed_in(plot.left(), plot.right() - 4), 0);
  EXPECT_TRUE(view.accessibleDescription().contains("saturated at 4095 DN"));
}

TEST_F(HistogramViewTest, WithoutCountsItSaysSo) {
  view.set_histogram({});
  const QImage empty = view.grab().toImage();
  view.set_placeholder("not measured yet");
  EXPECT_NE(view.grab().toImage(), empty);
  EXPECT_EQ(view.text_at({200, 50}), "");
}

TEST(ValueText, SaysNumbersForPeople) {
  EXPECT_EQ(value_text(0), "0");
  EXPECT_EQ(value_text(0.012345), "0.0123");
  EXPECT_EQ(value_text(-1.5), "−1.5");
  EXPECT_EQ(value_text(999.9), "1000");
  EXPECT_EQ(value_text(0.00001234), "1.23·10⁻⁵");
  EXPECT_EQ(value_text(2.5e7), "2.5·10⁷");
  EXPECT_EQ(value_text(std::nan("")), "not known");
  EXPECT_EQ(unit_text("W/(m^2 sr)"), "W/(m² sr)");
  EXPECT_EQ(cell_unit_text(Quantity::luminance), "cd/m² per mm²");
}

TEST(AxisTicks, AreRoundAndFew) {
  EXPECT_EQ(axis_ticks(0, 4096, 5), (std::vector<double>{0, 1000, 2000, 3000, 4000}));
  EXPECT_EQ(axis_ticks(0, 1, 3), (std::vector<double>{0, 0.5, 1}));
  EXPECT_EQ(axis_ticks(-1, 1, 3), (std::vector<double>{-1, 0, 1}));
  EXPECT_TRUE(axis_ticks(1, 1, 3).empty());
  EXPECT_TRUE(axis_ticks(0, INFINITY, 3).empty());
  EXPECT_EQ(decade_ticks(0.01, 100, 5), (std::vector<double>{0.01, 0.1, 1, 10, 100}));
  EXPECT_EQ(decade_ticks(0.03, 300, 2).size(), 2U);
}

}  // namespace
}  // namespace lumifield
