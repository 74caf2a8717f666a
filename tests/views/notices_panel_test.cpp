#include "app/views/notices_panel.h"

#include <QAbstractItemModelTester>
#include <QClipboard>
#include <QGuiApplication>
#include <QLineEdit>
#include <QListView>
#include <QPushButton>
#include <QScrollBar>
#include <QSignalSpy>
#include <QTest>
#include <QVBoxLayout>
#include <gtest/gtest.h>

namespace lumifield {
namespace {

using enum OperatorNotice::Level;

QStringList texts(const NoticesModel& model) {
  QStringList all;
  for (int row = 0; row < model.rowCount(); ++row) all << model.data(model.index(row)).toString();
  return all;
}

TEST(NoticesModel, WhatIsToldAgainIsCountedAndBecomesTheNewest) {
  QDateTime now(QDate(2024, 5, 7), QTime(12, 0, 0));
  NoticesModel model(nullptr, [&] { return now; });
  QAbstractItemModelTester tester(&model, QAbstractItemModelTester::FailureReportingMode::Fatal);
  QSignalSpy counts(&model, &NoticesModel::countsChanged);
  model.add({warning, "a"});
  now = now.addSecs(1);
  model.add({fault, "a"});
  model.add({information, "b"});
  now = now.addSecs(60);
  model.add({warning, "a"});
  EXPECT_EQ(texts(model), QStringList({"a", "b", "a"}));
  EXPECT_EQ(model.line(0), "2024-05-07 12:00:01  fault  a");
  EXPECT_EQ(model.line(2), "2024-05-07 12:01:01  warning  a  (2 times since 12:00:00)");
  EXPECT_EQ(counts.last(), QVariantList({1, 1, 1}));
  model.add({warning, "a"});
  EXPECT_EQ(model.data(model.index(2), NoticesModel::times_role).toInt(), 3);
  model.clear();
  EXPECT_EQ(counts.last(), QVariantList({0, 0, 0}));
}

TEST(NoticesModel, KeepsTheLastThousand) {
  NoticesModel model;
  for (int k = 0; k < NoticesModel::most_notices + 5; ++k) model.add({k < 10 ? fault : warning, QString::number(k)});
  EXPECT_EQ(model.rowCount(), NoticesModel::most_notices);
  EXPECT_EQ(texts(model).first(), "5");
  EXPECT_EQ(texts(model).last(), QString::number(NoticesModel::most_notices + 4));
  EXPECT_EQ(model.count(fault), 5);
}

/// A panel beside a field in which the operator types.
struct Window {
  QWidget window;
  QLineEdit* field = new QLineEdit(&window);
  NoticesPanel* panel = new NoticesPanel(&window);
  QListView* list = panel->findChild<QListView*>();

  Window() {
    auto* rows = new QVBoxLayout(&window);
    rows->addWidget(field);
    rows->addWidget(panel);
    window.resize(400, 250);
    window.show();
    window.activateWindow();
  }
  QPushButton* button(const QString& text) {
    for (QPushButton* one : panel->findChildren<QPushButton*>())
      if (one->text() == text) return one;
    return nullptr;
  }
};

TEST(NoticesPanel, NeverTakesTheFocusAndFollowsOnlyFromTheEnd) {
  Window w;
  ASSERT_TRUE(QTest::qWaitForWindowActive(&w.window));
  w.field->setFocus();
  for (int k = 0; k < 40; ++k) w.panel->add({fault, QString("notice %1").arg(k)});
  QScrollBar* bar = w.list->verticalScrollBar();
  EXPECT_TRUE(QTest::qWaitFor([&] { return bar->maximum() > 0 && bar->value() == bar->maximum(); }));
  EXPECT_TRUE(w.field->hasFocus());
  QTest::keyClicks(QApplication::focusWidget(), "typed");
  EXPECT_EQ(w.field->text(), "typed");

  bar->setValue(0);  // the operator reads an old one
  w.panel->add({fault, "another"});
  QCoreApplication::processEvents();
  EXPECT_EQ(bar->value(), 0);
}

TEST(NoticesPanel, LongTextsWrapToTheListsWidth) {
  Window w;
  w.panel->add({fault, "short"});
  w.panel->add(
      {fault, QString("cell (3, 4): the stage stands at 3.25 mm instead of 3.75 mm; check the belt. ").repeated(3)});
  QCoreApplication::processEvents();
  const auto height = [&](int row) { return w.list->visualRect(w.panel->notices().index(row)).height(); };
  const int before = height(1);
  EXPECT_GT(before, 3 * height(0));
  w.window.resize(800, 250);
  EXPECT_TRUE(QTest::qWaitFor([&] { return height(1) < before; }));
}

TEST(NoticesPanel, CopiesTheSelectedOrAllAndClears) {
  Window w;
  QSignalSpy counts(w.panel, &NoticesPanel::countsChanged);
  EXPECT_FALSE(w.button("Copy")->isEnabled());
  w.panel->add({fault, "one"});
  w.panel->add({warning, "two"});
  w.panel->add({information, "three"});
  QCoreApplication::processEvents();
  QTest::mouseClick(w.button("Copy"), Qt::LeftButton);
  EXPECT_EQ(QGuiApplication::clipboard()->text().count('\n'), 2);
  QTest::mouseClick(w.list->viewport(), Qt::LeftButton, {}, w.list->visualRect(w.panel->notices().index(1)).center());
  QTest::keyClick(w.list, Qt::Key_C, Qt::ControlModifier);
  EXPECT_TRUE(QGuiApplication::clipboard()->text().endsWith("warning  two"));
  QTest::keyClick(w.list, Qt::Key_Down, Qt::ShiftModifier);
  QTest::keyClick(w.list, Qt::Key_C, Qt::ControlModifier);
  EXPECT_TRUE(QGuiApplication::clipboard()->text().endsWith("information  three"));
  EXPECT_EQ(QGuiApplication::clipboard()->text().count('\n'), 1);
  QTest::mouseClick(w.button("Clear"), Qt::LeftButton);
  EXPECT_EQ(w.panel->notices().rowCount(), 0);
  EXPECT_EQ(counts.last(), QVariantList({0, 0, 0}));
}

TEST(NoticesPanel, CountsWhatCameOutOfSight) {
  NoticesPanel panel;
  QSignalSpy unread(&panel, &NoticesPanel::unreadChanged);
  panel.add({warning, "one"});
  panel.add({warning, "one"});
  EXPECT_EQ(unread.last(), QVariantList({2})) << "told again is new again";
  panel.set_in_sight(true);
  EXPECT_EQ(unread.last(), QVariantList({0}));
  panel.add({fault, "two"});
  EXPECT_EQ(unread.count(), 3) << "seen as it comes";
  panel.set_in_sight(false);
  panel.add({information, "three"});
  EXPECT_EQ(unread.last(), QVariantList({1}));
  panel.clear();
  EXPECT_EQ(unread.last(), QVariantList({0}));
}

}  // namespace
}  // namespace lumifield
