#include "app/views/scan_panel.h"

#include <QAction>
#include <QLabel>
#include <QProgressBar>
#include <QPushButton>
#include <QSignalSpy>
#include <QTemporaryDir>
#include <QTest>
#include <gtest/gtest.h>

#include "app/views/disk_watch.h"
#include "app/views/scan_controls.h"
#include "app/views/scan_words.h"

namespace lumifield {
namespace {

using enum ScanActivity;

QPushButton* button(QWidget& panel, const QString& text) {
  for (QPushButton* one : panel.findChildren<QPushButton*>())
    if (one->text() == text) return one;
  return nullptr;
}

/// The value under a name of the figures.
QLabel* figure(QWidget& panel, const QString& name) {
  for (QLabel* label : panel.findChildren<QLabel*>())
    if (label->accessibleName().startsWith(name + ": ")) return label;
  return nullptr;
}

QString figure_text(QWidget& panel, const QString& name) {
  const QLabel* label = figure(panel, name);
  return label ? label->text() : "no such figure";
}

bool has_text(QWidget& panel, const QString& text) {
  for (const QLabel* label : panel.findChildren<QLabel*>())
    if (label->text() == text) return true;
  return false;
}

void press(QWidget& panel, const QString& text) {
  QPushButton* one = button(panel, text);
  ASSERT_NE(one, nullptr) << text.toStdString();
  QTest::mouseClick(one, Qt::LeftButton);
}

QStringList enabled(QWidget& panel) {
  QStringList all;
  for (const char* text : {"Start", "Rehearse", "Pause", "Resume", "Stop…"})
    if (button(panel, text)->isEnabled()) all << text;
  return all;
}

ScanProgress progress_of(int done) {
  return {ScanState::exposing, done, 63, 0, CellIndex{3, 4}, "cell (3, 4)", 4000, 205, {}};
}

TEST(ScanPanel, SaysHowFarAndWhatAndWhenItEnds) {
  QDateTime now(QDate(2024, 5, 7), QTime(23, 58, 0));
  ScanPanel panel(nullptr, [&] { return now; });
  panel.set_activity(starting);
  panel.set_activity(running);
  panel.set_progress(progress_of(37));
  EXPECT_EQ(panel.findChild<QProgressBar*>()->text(), "37 of 63 cells");
  EXPECT_TRUE(has_text(panel, "Exposing, cell (3, 4)"));
  EXPECT_EQ(figure_text(panel, "Elapsed"), "1:06:40");
  EXPECT_EQ(figure_text(panel, "Time left"), "03:25");
  EXPECT_EQ(figure_text(panel, "Ends"), "Wed 00:01");
  panel.set_drift(-0.0035, 0.01);
  EXPECT_EQ(figure_text(panel, "Drift"), "−0.35 %");
  panel.set_drift(0.02, 0.01);
  EXPECT_EQ(figure_text(panel, "Drift"), "+2.00 % ⚠");
}

TEST(ScanPanel, SaysHowSteadyTheLampIs) {
  ScanPanel panel;
  panel.set_activity(starting);
  panel.set_activity(running);
  ScanProgress progress = progress_of(0);
  progress.stabilisation = {12345.6, 0.0123, 0.005, 1750, 1800};
  panel.set_progress(progress);
  EXPECT_TRUE(has_text(panel, "Lamp 12346 DN/s, spread 1.23 of 0.50 %, 29:10 at most: waiting until it is steady"));
}

TEST(ScanPanel, TheClockGoesOnBetweenTwoWordsButNotInAPause) {
  QDateTime now(QDate(2024, 5, 7), QTime(12, 0, 0));
  ScanPanel panel(nullptr, [&] { return now; });
  panel.set_activity(starting);
  panel.set_activity(running);
  panel.set_progress(progress_of(37));
  now = now.addSecs(5);
  EXPECT_TRUE(QTest::qWaitFor([&] { return figure_text(panel, "Time left") == "03:20"; }));
  EXPECT_EQ(figure_text(panel, "Elapsed"), "1:06:45");
  EXPECT_EQ(figure_text(panel, "Ends"), "12:03");
  panel.set_activity(paused);
  panel.set_progress(progress_of(38));
  now = now.addSecs(600);
  panel.set_drift(0, 0.01);
  EXPECT_EQ(figure_text(panel, "Time left"), "03:25");
  panel.set_activity(idle);
  EXPECT_EQ(figure_text(panel, "Time left"), "—");
  EXPECT_EQ(figure_text(panel, "Elapsed"), "1:06:40");
}

TEST(ScanPanel, ButtonsFollowTheScan) {
  ScanPanel panel;
  const std::vector<std::pair<ScanActivity, QStringList>> expected{{idle, {"Start", "Rehearse"}},
                                                                   {rehearsing, {"Stop…"}},
                                                                   {starting, {"Stop…"}},
                                                                   {running, {"Pause", "Stop…"}},
                                                                   {pausing, {"Resume", "Stop…"}},
                                                                   {paused, {"Resume", "Stop…"}},
                                                                   {stopping, {}}};
  for (const auto& [activity, buttons] : expected) {
    panel.set_activity(activity);
    EXPECT_EQ(enabled(panel), buttons) << static_cast<int>(activity);
  }
  panel.set_activity(idle);
  panel.set_startable(false, "Choose a plan first");
  EXPECT_EQ(enabled(panel), QStringList());
  EXPECT_TRUE(button(panel, "Start")->toolTip().startsWith("Choose a plan first"));
}

TEST(ScanPanel, ARehearsalIsAskedForAndStoppedWithoutAQuestion) {
  ScanPanel panel;
  panel.show();
  QSignalSpy start(&panel, &ScanPanel::startRequested), rehearse(&panel, &ScanPanel::rehearseRequested),
      stop(&panel, &ScanPanel::stopRequested);
  press(panel, "Rehearse");
  EXPECT_EQ(rehearse.count(), 1);
  EXPECT_EQ(start.count(), 0);
  panel.set_activity(idle);
  panel.set_progress(progress_of(37));
  panel.set_activity(rehearsing);
  ScanProgress tried = progress_of(62);
  tried.state = ScanState::settling;
  tried.place = "corner cell (0, 8), pass negative";
  panel.set_progress(tried);
  EXPECT_TRUE(has_text(panel, "Rehearsing: Letting the stage settle, corner cell (0, 8), pass negative"));
  EXPECT_EQ(panel.findChild<QProgressBar*>()->text(), "37 of 63 cells");
  press(panel, "Stop…");
  EXPECT_FALSE(panel.controls().asks_to_stop());
  EXPECT_EQ(stop.count(), 1);
}

TEST(ScanPanel, SaysWhatARehearsalTold) {
  Rehearsal told;
  told.camera = "Lumifield Virtual", told.stage = "Grbl 1.1h";
  told.places = 8, told.took_s = 12, told.shot = {1, 2};
  told.quality.saturated_share = 0.0012, told.quality.starved_share = 0.25, told.quality.median_snr = 80.4;
  told.quality.warnings = {"0.12 % of its pixels are saturated"};
  told.brightest_share = 0.412, told.signal_dn_per_s = 25'000.4;
  told.scan = {63, 105, 0, 45.36e6, 82.6e9};
  EXPECT_EQ(rehearsal_text(told),
            "Rehearsed in 00:12 on Lumifield Virtual and Grbl 1.1h: 8 corner places reached; test shot of cell (1, 2): "
            "brightest pixel at 41 % of saturation, 0.12 % of S saturated, 25.0 % starved, SNR 80, 0.12 % of its "
            "pixels are saturated; reference cell: 25000 DN/s; the scan: 63 cells, about 01:45 (min:s), up to 45.4 MB "
            "of the 82.6 GB that are free");
  told.scan.stabilisation_s = 1800;
  told.scan.free_bytes = 1e6;
  EXPECT_TRUE(
      rehearsal_text(told).endsWith("about 01:45 (min:s) once the lamp is steady, at most 30:00 before, up to "
                                    "45.4 MB of the 1.0 MB that are free: too little room, free some"));
}

TEST(ScanPanel, StopAsksFirstInThePanel) {
  ScanPanel panel;
  panel.show();
  QSignalSpy stop(&panel, &ScanPanel::stopRequested), pause(&panel, &ScanPanel::pauseRequested),
      resume(&panel, &ScanPanel::resumeRequested), start(&panel, &ScanPanel::startRequested);
  press(panel, "Start");
  panel.set_activity(running);
  press(panel, "Pause");
  panel.set_activity(paused);
  press(panel, "Resume");
  EXPECT_EQ(start.count() * pause.count() * resume.count(), 1);

  panel.set_activity(running);
  press(panel, "Stop…");
  EXPECT_TRUE(panel.controls().asks_to_stop());
  EXPECT_EQ(stop.count(), 0);
  press(panel, "&Keep scanning");
  EXPECT_FALSE(panel.controls().asks_to_stop());
  press(panel, "Stop…");
  QTest::keyClick(button(panel, "&Keep scanning"), Qt::Key_Escape);
  EXPECT_FALSE(panel.controls().asks_to_stop());
  EXPECT_EQ(stop.count(), 0);
  press(panel, "Stop…");
  press(panel, "&Stop the scan");
  EXPECT_EQ(stop.count(), 1);
  EXPECT_FALSE(panel.controls().asks_to_stop());

  press(panel, "Stop…");
  panel.set_activity(idle);  // it ended meanwhile
  EXPECT_FALSE(panel.controls().asks_to_stop());
}

TEST(ScanPanel, KeysDoWhatTheButtonsDo) {
  ScanPanel panel;
  QSignalSpy stop(&panel, &ScanPanel::stopRequested), pause(&panel, &ScanPanel::pauseRequested),
      resume(&panel, &ScanPanel::resumeRequested), start(&panel, &ScanPanel::startRequested);
  panel.show();
  panel.activateWindow();
  ASSERT_TRUE(QTest::qWaitForWindowActive(&panel));
  QTest::keyClick(&panel, Qt::Key_F6);
  EXPECT_EQ(pause.count() + resume.count(), 0);
  QTest::keyClick(&panel, Qt::Key_F5);
  EXPECT_EQ(start.count(), 1);
  panel.set_activity(running);
  QTest::keyClick(&panel, Qt::Key_F6);
  EXPECT_EQ(pause.count(), 1);
  panel.set_activity(paused);
  QTest::keyClick(&panel, Qt::Key_F6);
  EXPECT_EQ(resume.count(), 1);
  // A second time is no answer to the question.
  QTest::keyClick(&panel, Qt::Key_F5, Qt::ShiftModifier);
  QTest::keyClick(&panel, Qt::Key_F5, Qt::ShiftModifier);
  EXPECT_TRUE(panel.controls().asks_to_stop());
  EXPECT_EQ(stop.count(), 0);
  QTest::keyClick(panel.focusWidget(), Qt::Key_Space);  // on the answer that changes nothing
  EXPECT_FALSE(panel.controls().asks_to_stop());
  EXPECT_EQ(stop.count(), 0);
  // Return answers as Space does.
  QTest::keyClick(&panel, Qt::Key_F5, Qt::ShiftModifier);
  QTest::keyClick(panel.focusWidget(), Qt::Key_Backtab, Qt::ShiftModifier);
  QTest::keyClick(panel.focusWidget(), Qt::Key_Return);
  EXPECT_FALSE(panel.controls().asks_to_stop());
  EXPECT_EQ(stop.count(), 1);
}

TEST(ScanPanel, SaysHowTheScanEndedUntilTheNext) {
  ScanPanel panel;
  panel.set_activity(running);
  panel.set_activity(idle);
  panel.set_outcome("All 63 cells are measured.");
  EXPECT_TRUE(has_text(panel, "All 63 cells are measured."));
  panel.set_activity(starting);
  EXPECT_TRUE(has_text(panel, "Starting: checking plan, bench and devices"));
  EXPECT_FALSE(has_text(panel, "All 63 cells are measured."));
}

TEST(ScanPanel, IsLowWhenWideAndOneColumnWhenNarrow) {
  ScanPanel panel;
  panel.resize(1280, 80);
  panel.show();
  QCoreApplication::processEvents();
  EXPECT_LE(panel.minimumSizeHint().height(), 90);
  EXPECT_EQ(panel.height(), 80);
  panel.resize(panel.minimumSizeHint().width(), 300);
  QCoreApplication::processEvents();
  EXPECT_EQ(panel.width(), 360);
  for (const QPushButton* child : panel.findChildren<QPushButton*>()) {
    if (!child->isVisible()) continue;
    EXPECT_LE(child->mapTo(&panel, QPoint(child->width(), 0)).x(), 360) << child->text().toStdString();
    EXPECT_GE(child->width(), child->fontMetrics().horizontalAdvance(child->text())) << child->text().toStdString();
  }
}

TEST(ScanPanel, TellsTheDisksRoomAndWarnsWhenItDoesNotSuffice) {
  QTemporaryDir folder;
  const std::filesystem::path out = std::filesystem::path(folder.path().toStdString()) / "not" / "there.lumi";
  ScanPanel panel;
  panel.set_dataset(out, 1e30, 63);
  EXPECT_TRUE(QTest::qWaitFor([&] { return figure_text(panel, "Disk left").endsWith("room for 0 cells ⚠"); }));
  panel.set_dataset(out, 1, 63);
  EXPECT_TRUE(QTest::qWaitFor([&] { return figure_text(panel, "Disk left").endsWith("scans"); }));
  EXPECT_TRUE(figure(panel, "Disk left")->toolTip().contains("GB"));
}

TEST(DiskWatch, ReadsTheNearestFolderThatIsThereAgainAndAgain) {
  QTemporaryDir folder;
  DiskWatch watch(nullptr, std::chrono::milliseconds(10));
  QSignalSpy read(&watch, &DiskWatch::roomRead), failed(&watch, &DiskWatch::failed);
  watch.watch(std::filesystem::path(folder.path().toStdString()) / "a" / "b");
  EXPECT_TRUE(QTest::qWaitFor([&] { return read.count() >= 3; }));
  EXPECT_GT(read.at(0).at(0).toDouble(), 0);
  EXPECT_EQ(failed.count(), 0);
  watch.watch({});
  read.clear();
  QTest::qWait(100);
  EXPECT_EQ(read.count(), 0);
}

TEST(ScanWords, FiguresReadWell) {
  EXPECT_EQ(duration_text(0), "00:00");
  EXPECT_EQ(duration_text(59.6), "01:00");
  EXPECT_EQ(duration_text(36000), "10:00:00");
  EXPECT_EQ(duration_text(-1), "—");
  EXPECT_EQ(bytes_text(999), "999 B");
  EXPECT_EQ(bytes_text(999.6), "1.0 kB");
  EXPECT_EQ(bytes_text(12.34e9), "12.3 GB");
  EXPECT_EQ(bytes_text(118e9), "118 GB");
  EXPECT_EQ(room_text(1000, 10, 63), "room for 1 scan");
  EXPECT_EQ(room_text(100, 10, 63), "room for 10 cells");
  const QDateTime now(QDate(2024, 5, 7), QTime(12, 0));
  EXPECT_EQ(clock_text(now.addDays(10), now), "17 May 12:00");
  EXPECT_EQ(drift_text(std::nan("")), "—");
}

}  // namespace
}  // namespace lumifield
