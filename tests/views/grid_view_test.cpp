#include "app/views/grid_view.h"

#include <QAction>
#include <QApplication>
#include <QComboBox>
#include <QContextMenuEvent>
#include <QMenu>
#include <QPushButton>
#include <QSignalSpy>
#include <QTest>
#include <QTimer>
#include <gtest/gtest.h>
#include <set>

#include "app/views/colour_bar.h"
#include "app/views/grid_map.h"
#include "app/views/state_legend.h"
#include "renderer/false_colour.h"
#include "tests/views/lamp_model.h"

namespace lumifield {
namespace {

using Cells = std::set<CellIndex>;

struct GridViewTest : testing::Test {
  void SetUp() override {
    view.resize(400, 460);
    view.show();
    ASSERT_TRUE(QTest::qWaitForWindowExposed(&view));
    QObject::connect(&view, &GridView::cellSelected, [this](CellIndex cell) { chosen.push_back(cell); });
    QObject::connect(&view, &GridView::retakeRequested,
                     [this](const std::vector<CellIndex>& cells) { retaken.push_back(cells); });
  }
  void fill(int columns, int rows) {
    const LuminaireGeometry geometry = lamp_geometry(columns, rows);
    model.reset(geometry, "lamp");
    for (int k = 0; k < geometry.sampling.cells(); ++k)
      model.put(entry_of(geometry.sampling.index(k)), flat_image(geometry, static_cast<float>(k)));
  }
  QPoint middle(CellIndex cell) { return view.map().cell_rect(cell).center().toPoint(); }
  void click(CellIndex cell, Qt::KeyboardModifiers with = {}) {
    QTest::mouseClick(&view.map(), Qt::LeftButton, with, middle(cell));
  }
  void key(Qt::Key key, Qt::KeyboardModifiers with = {}) { QTest::keyClick(&view.map(), key, with); }
  /// Opens the context menu over a cell and triggers the entry that begins so, when it is enabled.
  bool pick(CellIndex over, const QString& begin) {
    bool picked = false;
    QTimer::singleShot(0, [&] {
      auto* menu = qobject_cast<QMenu*>(QApplication::activePopupWidget());
      if (!menu) return;
      for (QAction* action : menu->actions())
        if (action->text().startsWith(begin) && action->isEnabled()) {
          picked = true;
          QTest::mouseClick(menu, Qt::LeftButton, {}, menu->actionGeometry(action).center());
        }
      menu->close();
    });
    QContextMenuEvent event(QContextMenuEvent::Mouse, middle(over), view.map().mapToGlobal(middle(over)));
    QApplication::sendEvent(&view.map(), &event);
    return picked;
  }
  LuminaireModel model;
  GridView view{model};
  std::vector<CellIndex> chosen;
  std::vector<std::vector<CellIndex>> retaken;
};

TEST_F(GridViewTest, PlusXIsToTheRightAndPlusYUp) {
  fill(9, 7);
  EXPECT_LT(middle({0, 0}).x(), middle({0, 8}).x());
  EXPECT_GT(middle({0, 0}).y(), middle({6, 0}).y());
  EXPECT_EQ(view.map().cell_at(middle({3, 5})), (CellIndex{3, 5}));
  EXPECT_EQ(view.map().cell_at({1, 1}), std::nullopt);
  EXPECT_TRUE(view.map().text_at({1, 1}).contains("+x to the right, +y up"));
  EXPECT_TRUE(view.map().text_at(middle({3, 5})).contains("row 3, column 5"));
}

TEST_F(GridViewTest, EveryCellIsHitFromOneToFortyASide) {
  for (const auto& [columns, rows] : {std::pair(1, 1), std::pair(40, 40), std::pair(40, 1), std::pair(1, 40)}) {
    fill(columns, rows);
    const QRectF inside = QRectF(view.map().rect());
    for (int k = 0; k < columns * rows; ++k) {
      const CellIndex cell = model.geometry()->sampling.index(k);
      ASSERT_TRUE(inside.contains(view.map().cell_rect(cell))) << columns << " x " << rows;
      ASSERT_EQ(view.map().cell_at(view.map().cell_rect(cell).center()), cell);
      ASSERT_GE(view.map().cell_rect(cell).width(), 3);
    }
  }
}

TEST_F(GridViewTest, ClicksChooseWithControlAndShiftMany) {
  fill(9, 7);
  click({2, 2});
  click({4, 4}, Qt::ControlModifier);
  EXPECT_EQ(view.map().selected(), (Cells{{2, 2}, {4, 4}}));
  click({5, 5}, Qt::ShiftModifier);
  EXPECT_EQ(view.map().selected(), (Cells{{4, 4}, {4, 5}, {5, 4}, {5, 5}}));
  click({0, 0});
  EXPECT_EQ(view.map().selected(), (Cells{{0, 0}}));
  EXPECT_EQ(chosen, (std::vector<CellIndex>{{2, 2}, {4, 4}, {5, 5}, {0, 0}}));
}

TEST_F(GridViewTest, ARubberBandSelectsWhatItTouches) {
  fill(9, 7);
  click({6, 8});
  const auto band = [&](CellIndex from, CellIndex to, Qt::KeyboardModifiers with) {
    QTest::mousePress(&view.map(), Qt::LeftButton, with, middle(from));
    QTest::mouseMove(&view.map(), (middle(from) + middle(to)) / 2);
    QTest::mouseMove(&view.map(), middle(to));
    QTest::mouseRelease(&view.map(), Qt::LeftButton, with, middle(to));
  };
  band({1, 1}, {2, 3}, Qt::ControlModifier);
  EXPECT_EQ(view.map().selected().size(), 7U);
  band({2, 3}, {1, 1}, {});
  EXPECT_EQ(view.map().selected(), (Cells{{1, 1}, {1, 2}, {1, 3}, {2, 1}, {2, 2}, {2, 3}}));
}

TEST_F(GridViewTest, ArrowsMoveShiftExtendsEnterOpens) {
  fill(9, 7);
  QSignalSpy opened(&view, &GridView::cellOpened);
  key(Qt::Key_Return);
  EXPECT_EQ(opened.count(), 0);
  key(Qt::Key_Up);  // the first arrow chooses the first cell
  key(Qt::Key_Up);
  key(Qt::Key_Right);
  EXPECT_EQ(view.map().current(), (CellIndex{1, 1}));
  key(Qt::Key_Down);
  key(Qt::Key_Down);
  key(Qt::Key_Left);
  key(Qt::Key_Left);
  EXPECT_EQ(view.map().current(), (CellIndex{0, 0}));
  key(Qt::Key_Right, Qt::ShiftModifier);
  key(Qt::Key_Up, Qt::ShiftModifier);
  EXPECT_EQ(view.map().selected(), (Cells{{0, 0}, {0, 1}, {1, 0}, {1, 1}}));
  key(Qt::Key_Space, Qt::ControlModifier);
  EXPECT_EQ(view.map().selected().count({1, 1}), 0U);
  key(Qt::Key_A, Qt::ControlModifier);
  EXPECT_EQ(view.map().selected().size(), 63U);
  key(Qt::Key_Return);
  ASSERT_EQ(opened.count(), 1);
  EXPECT_EQ(opened.at(0).at(0).value<CellIndex>(), (CellIndex{1, 1}));
  QTest::mouseDClick(&view.map(), Qt::LeftButton, {}, middle({3, 3}));
  EXPECT_EQ(opened.count(), 2);
  EXPECT_TRUE(view.map().accessibleDescription().contains("row 1, column 1"));
}

TEST_F(GridViewTest, TheContextMenuAsksForARetakeOfWhatIsMeasured) {
  const LuminaireGeometry geometry = lamp_geometry(3, 1);
  model.reset(geometry, "lamp");
  model.put(entry_of({0, 0}), flat_image(geometry, 1));
  model.put(entry_of({0, 1}, warned()), flat_image(geometry, 1));
  EXPECT_FALSE(pick({0, 2}, "Retake"));  // unmeasured
  click({0, 0});
  click({0, 1}, Qt::ControlModifier);
  click({0, 2}, Qt::ControlModifier);
  EXPECT_TRUE(pick({0, 1}, "Retake"));
  ASSERT_EQ(retaken.size(), 1U);
  EXPECT_EQ(retaken[0], (std::vector<CellIndex>{{0, 0}, {0, 1}}));

  EXPECT_TRUE(pick({0, 0}, "Select cells with warnings"));
  EXPECT_EQ(view.map().selected(), (Cells{{0, 1}}));
  EXPECT_TRUE(pick({0, 0}, "Retake"));  // outside the selection: about that cell
  EXPECT_EQ(retaken.at(1), (std::vector<CellIndex>{{0, 0}}));

  view.set_retake_possible(false, "No scan runs");
  EXPECT_FALSE(pick({0, 0}, "Retake"));
  EXPECT_EQ(retaken.size(), 2U);
}

TEST_F(GridViewTest, TheRetakeButtonSaysHowManyAndWhyNot) {
  fill(3, 1);
  auto* button = view.findChild<QPushButton*>();
  EXPECT_FALSE(button->isEnabled());
  click({0, 0});
  click({0, 2}, Qt::ShiftModifier);
  EXPECT_TRUE(button->text().contains("3"));
  model.set_waiting({{0, 1}});
  EXPECT_TRUE(QTest::qWaitFor([&] { return button->text().contains("2"); }));
  QTest::mouseClick(button, Qt::LeftButton);
  ASSERT_EQ(retaken.size(), 1U);
  EXPECT_EQ(retaken[0], (std::vector<CellIndex>{{0, 0}, {0, 2}}));
  view.set_retake_possible(false, "No scan runs");
  EXPECT_FALSE(button->isEnabled());
  EXPECT_EQ(button->toolTip(), "No scan runs");
}

TEST_F(GridViewTest, StatesDifferWithoutColour) {
  const LuminaireGeometry geometry = lamp_geometry(5, 1);
  model.reset(geometry, "lamp");
  for (int k = 1; k < 5; ++k) model.put(entry_of({0, k}, k == 4 ? warned() : Quality{}), flat_image(geometry, 1));
  model.set_measuring(CellIndex{0, 1});
  model.set_waiting({{0, 2}});
  EXPECT_EQ(view.findChild<StateLegend*>()->counts(), (std::array<int, 6>{5, 0, 0, 0, 0, 0}));
  const std::array<int, 6> one_each{1, 1, 1, 1, 1, 0};  // none is damaged
  EXPECT_TRUE(QTest::qWaitFor([&] { return view.findChild<StateLegend*>()->counts() == one_each; }));
  // Each cell in black and white, against its own corner's lightness: a picture of its mark.
  const QImage shown = view.map().grab().toImage();
  std::set<std::vector<bool>> marks;
  for (int k = 1; k < 5; ++k) {
    const QRectF rect = view.map().cell_rect({0, k});
    const double ratio = view.devicePixelRatio();
    std::vector<bool> mark;
    const int ground = qGray(shown.pixel((rect.topLeft() * ratio).toPoint() + QPoint(3, 3)));
    for (int y = 6; y < rect.height() * ratio - 6; ++y)
      for (int x = 6; x < rect.width() * ratio - 6; ++x)
        mark.push_back(std::abs(qGray(shown.pixel((rect.topLeft() * ratio).toPoint() + QPoint(x, y))) - ground) > 60);
    marks.insert(mark);
  }
  EXPECT_EQ(marks.size(), 4U);
}

TEST_F(GridViewTest, AFigureColoursTheCellsAndItsScaleHasAUnit) {
  fill(3, 1);
  Quality unknown;
  unknown.median_snr = std::nan("");
  model.put(entry_of({0, 2}, unknown), flat_image(*model.geometry(), 2));
  auto* choice = view.findChild<QComboBox*>();
  auto* bar = view.findChild<ColourBar*>();
  EXPECT_FALSE(bar->isVisible());
  choice->setFocus();
  QTest::keyClick(choice, Qt::Key_End);
  EXPECT_EQ(choice->currentText(), "Constant-distance error");
  QTest::keyClick(choice, Qt::Key_Up);
  EXPECT_EQ(choice->currentText(), "Total light");
  EXPECT_TRUE(bar->isVisible());
  EXPECT_EQ(view.map().scale(), (ValueScale{0, 2 * 48 * 0.25}));
  EXPECT_TRUE(bar->accessibleDescription().contains("cd/m²"));
  const auto corner = [&](CellIndex cell) {
    const QPointF at = view.map().cell_rect(cell).topLeft() * view.devicePixelRatio();
    return view.map().grab().toImage().pixel(at.toPoint() + QPoint(4, 4));
  };
  EXPECT_EQ(corner({0, 1}), colour_of(view.map().scale(), 12));
  EXPECT_EQ(corner({0, 2}), colour_of(view.map().scale(), 24));
  model.put(entry_of({0, 0}), flat_image(*model.geometry(), 4));
  EXPECT_TRUE(QTest::qWaitFor([&] { return bar->scale().to == 48; }));
}

TEST_F(GridViewTest, AFigureNotKnownIsHatched) {
  fill(2, 1);
  Quality unknown;
  unknown.median_snr = std::nan("");
  model.put(entry_of({0, 1}, unknown), flat_image(*model.geometry(), 2));
  view.findChild<QComboBox*>()->setCurrentText("Median SNR");
  const QImage shown = view.map().grab().toImage();
  const auto colours = [&](CellIndex cell) {
    std::set<QRgb> all;
    const QRectF rect = view.map().cell_rect(cell);
    const double ratio = view.devicePixelRatio();
    for (double x = rect.left() + 2; x < rect.right() - 2; ++x)  // above the number
      all.insert(shown.pixel((QPointF(x, rect.top() + 0.2 * rect.height()) * ratio).toPoint()));
    return all.size();
  };
  EXPECT_EQ(colours({0, 0}), 1U);
  EXPECT_GT(colours({0, 1}), 1U);
}

TEST_F(GridViewTest, WithoutALuminaireItSaysSoAndAnotherForgetsTheChoice) {
  EXPECT_EQ(view.map().cell_at({200, 200}), std::nullopt);
  QTest::mouseClick(&view.map(), Qt::LeftButton, {}, {200, 150});
  key(Qt::Key_Right);
  EXPECT_TRUE(chosen.empty());
  const QImage placeholder = view.map().grab().toImage();
  fill(3, 3);
  EXPECT_NE(view.map().grab().toImage(), placeholder);
  click({2, 2});
  fill(2, 2);
  EXPECT_EQ(view.map().current(), std::nullopt);
  EXPECT_TRUE(view.map().selected().empty());
  view.map().choose({2, 2});
  EXPECT_EQ(view.map().current(), std::nullopt);
}

TEST(StateLegend, MeasuredCellsHaveTheColoursOfTheMap) {
  StateLegend legend;
  legend.resize(legend.sizeHint());
  const auto colours = [&] {
    const QImage image = legend.grab().toImage();
    std::set<QRgb> seen;
    for (int x = 0; x < image.width(); ++x)
      for (int y = 0; y < image.height(); ++y) seen.insert(image.pixel(x, y));
    return seen;
  };
  const auto has = [&](double share) {
    const auto [r, g, b] = false_colour(share);
    return colours().contains(qRgb(r, g, b));
  };
  const QRgb state = qRgb(92, 134, 176);
  EXPECT_TRUE(colours().contains(state));
  EXPECT_FALSE(has(0.5 / 16));
  legend.set_by_figure(true);
  EXPECT_FALSE(colours().contains(state));
  EXPECT_TRUE(has(0.5 / 16));
  EXPECT_TRUE(has(15.5 / 16));
}

TEST_F(GridViewTest, AnotherColouringMovesNothing) {
  fill(9, 7);
  const int least = view.minimumSizeHint().height();
  const QRect map = view.map().geometry();
  view.findChild<QComboBox*>()->setCurrentIndex(3);
  QApplication::processEvents();
  EXPECT_TRUE(view.findChild<ColourBar*>()->isVisible());
  EXPECT_EQ(view.minimumSizeHint().height(), least);
  EXPECT_EQ(view.map().geometry(), map);
}

}  // namespace
}  // namespace lumifield
