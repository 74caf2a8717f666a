#include "app/views/study_panel.h"

#include <QAbstractItemModelTester>
#include <QAccessible>
#include <QHeaderView>
#include <QHelpEvent>
#include <QLabel>
#include <QPushButton>
#include <QSignalSpy>
#include <QTabBar>
#include <QTabWidget>
#include <QTest>
#include <QToolTip>
#include <gtest/gtest.h>

#include "app/session/study_file.h"
#include "app/views/elided_label.h"
#include "app/views/signal_colours.h"
#include "app/views/stability_model.h"
#include "app/views/stability_view.h"
#include "app/views/study_chart.h"
#include "app/views/theme.h"
#include "tests/support/dataset_folder.h"
#include "tests/support/made_up_study.h"

namespace lumifield {
namespace {

StabilityRow row(Method method, const char* name, StabilityOutcome outcome, double rel_error, const char* reason) {
  return {method, name, outcome, rel_error, reason};
}

QString shown(const StabilityModel& model, int down, int across, int role = Qt::DisplayRole) {
  return model.data(model.index(down, across), role).toString();
}

TEST(StabilityModel, HasACaseInEachRowAndAMethodInEachColumn) {
  using enum StabilityOutcome;
  StabilityModel model;
  QAbstractItemModelTester tester(&model, QAbstractItemModelTester::FailureReportingMode::Fatal);
  model.set_rows({row(Method::far_field, "on S", refused, std::nan(""), "too near"),
                  row(Method::closed_form, "on S", ok, 1.2e-7, ""), row(Method::closed_form, "grazing", ok, 0.02, ""),
                  row(Method::closed_form, "grazing", failed, 0.5, "of another luminaire"),
                  row(Method::closed_form, "grazing", refused, 0.1, "")});
  ASSERT_EQ(model.rowCount(), 2);
  ASSERT_EQ(model.columnCount(), 2);
  EXPECT_EQ(model.headerData(0, Qt::Vertical).toString(), "on S");
  EXPECT_EQ(model.headerData(1, Qt::Horizontal).toString(), "closed-form");
  EXPECT_EQ(shown(model, 0, 0), "refused");
  EXPECT_TRUE(shown(model, 0, 0, Qt::ToolTipRole).contains("too near"));
  EXPECT_EQ(shown(model, 0, 1), "ok  1.2·10⁻⁷");
  EXPECT_EQ(shown(model, 1, 0), "not tried");
  EXPECT_EQ(shown(model, 1, 1), "failed  0.5");  // the worst of three
  model.set_rows({});
  EXPECT_EQ(model.rowCount(), 0);
}

TEST(StabilityModel, OutcomesDifferInColourAndStayLegible) {
  using enum StabilityOutcome;
  StabilityModel model;
  model.set_rows({row(Method::closed_form, "a", ok, 0, ""), row(Method::closed_form, "b", refused, 0, ""),
                  row(Method::closed_form, "c", failed, 0, "")});
  for (const Theme theme : {Theme::light, Theme::dark}) {
    model.set_palette(palette_of(theme));
    std::vector<QColor> grounds;
    for (int k = 0; k < 3; ++k) {
      grounds.push_back(model.data(model.index(k, 0), Qt::BackgroundRole).value<QColor>());
      EXPECT_GE(contrast(grounds.back(), model.data(model.index(k, 0), Qt::ForegroundRole).value<QColor>()), 4.5);
    }
    EXPECT_NE(grounds[0], grounds[1]);
    EXPECT_NE(grounds[1], grounds[2]);
    EXPECT_NE(grounds[0], grounds[2]);
  }
}

class StudyPanelTest : public support::TemporaryFolder {
 protected:
  void SetUp() override {
    ASSERT_TRUE(write_study(test::made_up_study(), folder_));
    panel.resize(1000, 720);
    panel.show();
    ASSERT_TRUE(QTest::qWaitForWindowExposed(&panel));
  }
  QString file() const { return QString::fromStdString((folder_ / "study.json").string()); }
  bool says(const QString& part) const {
    for (const QLabel* label : panel.findChildren<QLabel*>())
      if (label->isVisible() && label->text().contains(part)) return true;
    return false;
  }

  StudyPanel panel;
};

TEST_F(StudyPanelTest, SaysHowToMakeAStudyWhileThereIsNone) {
  EXPECT_TRUE(says("No study is open"));
  EXPECT_TRUE(says("lumifield study --luminaire"));
  EXPECT_FALSE(panel.chart().isVisible());
}

TEST_F(StudyPanelTest, ShowsChartAndTable) {
  QSignalSpy opened(&panel, &StudyPanel::opened);
  panel.open(file());
  ASSERT_TRUE(opened.wait());
  EXPECT_EQ(opened[0][0].toString(), file());
  EXPECT_TRUE(panel.chart().isVisible());
  auto* tabs = panel.findChild<QTabBar*>();
  EXPECT_EQ(tabs->tabText(1), "&Stability (1 failed)");
  QTest::mouseClick(tabs, Qt::LeftButton, {}, tabs->tabRect(1).center());
  EXPECT_TRUE(panel.table().isVisible());
  EXPECT_EQ(panel.table().model()->rowCount(), 8);

  // The reason of a refusal is the cell's tooltip.
  StabilityView& table = panel.table();
  const QModelIndex far = table.model()->index(0, static_cast<int>(Method::far_field));
  table.scrollTo(far);
  const QPoint at = table.visualRect(far).center();
  QHelpEvent help(QEvent::ToolTip, at, table.viewport()->mapToGlobal(at));
  QCoreApplication::sendEvent(table.viewport(), &help);
  EXPECT_TRUE(QTest::qWaitFor([] { return QToolTip::text().contains("nearer than five times"); }));
  QToolTip::hideText();

  // Keys move through it.
  table.setFocus();
  table.setCurrentIndex(table.model()->index(0, 0));
  QTest::keyClick(&table, Qt::Key_Down);
  EXPECT_EQ(table.currentIndex().row(), 1);
}

TEST_F(StudyPanelTest, SaysWhatAStudyIsWithout) {
  Study study = test::made_up_study();
  study.omissions = {{"Table 1", "no room"}, {"bike, mis", "tables do not fit"}};
  ASSERT_TRUE(write_study(study, folder_));
  QSignalSpy opened(&panel, &StudyPanel::opened);
  panel.open(file());
  ASSERT_TRUE(opened.wait());
  QString summary;
  for (const QWidget* each : panel.findChildren<QWidget*>())
    if (const auto* label = dynamic_cast<const ElidedLabel*>(each)) summary += label->text();
  EXPECT_TRUE(summary.endsWith("; without Table 1; bike, mis")) << summary.toStdString();
}

TEST_F(StudyPanelTest, WhatCannotBeReadChangesNothing) {
  QSignalSpy opened(&panel, &StudyPanel::opened), noticed(&panel, &StudyPanel::noticed);
  panel.open(file());
  ASSERT_TRUE(opened.wait());
  support::write_text(folder_ / "other.json", R"({"format": "lumifield-study", "version": 2})");
  panel.open(QString::fromStdString((folder_ / "other.json").string()));
  ASSERT_TRUE(noticed.wait());
  EXPECT_TRUE(noticed[0][0].value<OperatorNotice>().text.contains("version"));
  EXPECT_EQ(opened.count(), 1);
  EXPECT_TRUE(panel.chart().isVisible());
}

TEST_F(StudyPanelTest, TheLastOneIsReadWhenThePanelIsSeen) {
  StudyPanel later;
  QSignalSpy opened(&later, &StudyPanel::opened), noticed(&later, &StudyPanel::noticed);
  later.remember(file());
  EXPECT_FALSE(opened.wait(100));
  later.show();
  EXPECT_TRUE(opened.wait());

  panel.remember(file() + ".gone");
  EXPECT_TRUE(QTest::qWaitFor([&] { return says("The last study cannot be shown"); }));
  EXPECT_EQ(noticed.count(), 0);
  EXPECT_TRUE(says("lumifield study --luminaire"));
}

TEST_F(StudyPanelTest, EveryControlHasANameForScreenReaders) {
  const auto check = [&](int fewest) {
    int controls = 0;
    for (QWidget* widget : panel.findChildren<QWidget*>()) {
      if (!widget->isVisible() || widget->focusPolicy() == Qt::NoFocus || widget->objectName().startsWith("qt_"))
        continue;
      ++controls;
      EXPECT_FALSE(QAccessible::queryAccessibleInterface(widget)->text(QAccessible::Name).isEmpty())
          << widget->metaObject()->className();
    }
    EXPECT_GE(controls, fewest);
  };
  check(2);
  QSignalSpy opened(&panel, &StudyPanel::opened);
  panel.open(file());
  ASSERT_TRUE(opened.wait());
  check(3);
  panel.findChild<QTabWidget*>()->setCurrentIndex(1);
  check(3);
}

}  // namespace
}  // namespace lumifield
