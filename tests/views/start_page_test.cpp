#include "app/views/start_page.h"

#include <QDragEnterEvent>
#include <QDropEvent>
#include <QLabel>
#include <QLineEdit>
#include <QListWidget>
#include <QMimeData>
#include <QPushButton>
#include <QSettings>
#include <QSignalSpy>
#include <QTemporaryDir>
#include <QTest>
#include <QUrl>
#include <fstream>
#include <gtest/gtest.h>

#include "app/views/new_scan_dialog.h"
#include "luminaire/dataset.h"
#include "tests/support/small_bench.h"

namespace lumifield {
namespace {

/// Bench and plan of 3 × 2 cells, in a folder of their own.
struct Files {
  QTemporaryDir folder;  ///< with the settings too
  std::filesystem::path at = folder.path().toStdString();
  NewScan scan{at / "bench.json", at / "plan.json", at / "lamp.lumi", {}};

  Files() {
    QSettings::setPath(QSettings::NativeFormat, QSettings::UserScope, folder.path());
    Bench bench = test::small_bench();
    bench.camera.address = "10.0.0.2";
    bench.stage.path = "/dev/ttyUSB0";
    bench.camera_model = {640, 480, 800, 800, 319.5, 239.5, {}, Pose::Identity(), {}};
    bench.sensor.responsivity = {1e6};
    Plan plan = test::small_plan();
    plan.measurement = {100, 80, {1, 1}, {0, 0}};
    std::ofstream(scan.bench) << to_json(bench);
    std::ofstream(scan.plan) << to_json(plan);
  }
};

template <class Widget>
Widget* named(QWidget& in, const QString& name) {
  for (Widget* one : in.findChildren<Widget*>())
    if (one->accessibleName() == name) return one;
  return nullptr;
}

QPushButton* button(QWidget& in, const QString& text) {
  for (QPushButton* one : in.findChildren<QPushButton*>())
    if (one->text() == text) return one;
  return nullptr;
}

void type(QWidget& in, const QString& field, const std::filesystem::path& path) {
  auto* line = named<QLineEdit>(in, field);
  line->setFocus();
  line->selectAll();
  QTest::keyClicks(line, QString::fromStdString(path.string()));
}

TEST(ScanForecast, TellsCellsTimeAndDiskSpace) {
  const Files files;
  const ScanForecast f = forecast(files.scan);
  ASSERT_TRUE(f.usable()) << f.faults.begin()->second.toStdString();
  EXPECT_EQ(f.to_do, 6);
  EXPECT_EQ(f.disk_bytes, 6 * 100 * 80 * 8);
  EXPECT_GT(f.predicted_s, 6 * 2 * 0.1);
  EXPECT_GT(f.free_bytes, 0);
  EXPECT_TRUE(forecast_text(f).startsWith("3 × 2 = 6 cells\nabout 00:")) << forecast_text(f).toStdString();
  EXPECT_TRUE(forecast_text(f).contains("up to 384 kB of the "));

  // It says which speed it takes.
  EXPECT_EQ(f.assumed_mm_s, 0);
  EXPECT_TRUE(forecast_text(f).contains("exposures and the stage's speed\n"));
  Bench silent = *read_bench(files.scan.bench);
  silent.stage.rapid_mm_s = 0;
  std::ofstream(files.scan.bench) << to_json(silent);
  const ScanForecast assumed = forecast(files.scan);
  EXPECT_EQ(assumed.assumed_mm_s, 10);
  EXPECT_GT(assumed.predicted_s, f.predicted_s);
  EXPECT_TRUE(forecast_text(assumed).contains("exposures and 10 mm/s, assumed since the bench file gives no speed\n"));
}

TEST(ScanForecast, NamesTheFieldThatIsWrong) {
  Files files;
  NewScan scan = files.scan;
  scan.out = files.at / "none" / "lamp.lumi";
  scan.scene = files.at / "scene.json";
  ScanForecast f = forecast(scan);
  EXPECT_TRUE(f.faults.contains(NewScanField::out));
  EXPECT_TRUE(f.faults.contains(NewScanField::scene));
  EXPECT_EQ(f.faults.size(), 2U);
  std::ofstream(files.scan.plan) << "{ \"format\": \"lumifield-plan\", \"version\": 9 }";
  f = forecast(files.scan);
  EXPECT_EQ(f.faults.size(), 1U);
  EXPECT_TRUE(f.faults[NewScanField::plan].contains("version")) << f.faults[NewScanField::plan].toStdString();
  EXPECT_EQ(forecast({}).faults.size(), 3U);
}

TEST(ScanForecast, GoesOnWithADatasetThatIsThereButNotWithAnythingElse) {
  Files files;
  std::filesystem::create_directory(files.scan.out);
  EXPECT_TRUE(forecast(files.scan).faults.contains(NewScanField::out));
  std::filesystem::remove(files.scan.out);
  Manifest manifest;
  manifest.name = "lamp";
  manifest.geometry.planes.separation_mm = 150;
  manifest.geometry.sampling = {BasisKind::bell, {7.5, 7.5}, 3, 2, {0, 0}};
  manifest.geometry.measurement = {4, 4, {1, 1}, {0, 0}};
  manifest.geometry.channels = {"Y"};
  auto writer = DatasetWriter::create(files.scan.out, manifest);
  ASSERT_TRUE(writer) << writer.error().message();
  ASSERT_TRUE(writer->add({1, 2}, {4, 4, 1, std::vector<float>(16, 1), {}, {}}, {0, 0}));
  const ScanForecast f = forecast(files.scan);
  ASSERT_TRUE(f.usable()) << f.faults.begin()->second.toStdString();
  EXPECT_EQ(f.done, 1);
  EXPECT_EQ(f.to_do, 5);
  EXPECT_TRUE(forecast_text(f).startsWith("3 × 2 = 6 cells, 1 of them measured already"));
}

TEST(NewScanDialog, ChecksWhatIsTypedAndHandsItOn) {
  const Files files;
  NewScanDialog dialog;
  QSignalSpy requested(&dialog, &NewScanDialog::newScanRequested);
  dialog.show();
  QPushButton* take = button(dialog, "Set up scan");
  type(dialog, "Bench file", files.scan.bench);
  type(dialog, "Plan file", files.at / "none.json");
  type(dialog, "Luminaire", files.scan.out);
  const auto says = [&](const QString& part) {
    for (const QLabel* label : dialog.findChildren<QLabel*>())
      if (label->isVisible() && label->text().contains(part)) return true;
    return false;
  };
  EXPECT_TRUE(QTest::qWaitFor([&] { return says("none.json"); }));
  EXPECT_FALSE(take->isEnabled());
  type(dialog, "Plan file", files.scan.plan);
  EXPECT_TRUE(QTest::qWaitFor([&] { return take->isEnabled(); }));
  EXPECT_FALSE(says("none.json"));
  EXPECT_TRUE(says("3 × 2 = 6 cells"));
  QTest::mouseClick(take, Qt::LeftButton);
  ASSERT_EQ(requested.count(), 1);
  const auto text = [](const std::filesystem::path& path) { return QString::fromStdString(path.string()); };
  EXPECT_EQ(requested[0], QVariantList({text(files.scan.bench), text(files.scan.plan), text(files.scan.out), ""}));
  EXPECT_FALSE(dialog.isVisible());
  EXPECT_EQ(NewScanDialog::suggested().plan, files.scan.plan);  // the next one begins there
  EXPECT_EQ(NewScanDialog::suggested().out.parent_path(), files.at);
}

TEST(StartPage, OpensWhatIsClickedChosenByKeyOrDropped) {
  QTemporaryDir folder;
  const QString there = folder.path(), gone = folder.filePath("gone.lumi");
  StartPage page;
  QSignalSpy opened(&page, &StartPage::openRequested);
  page.set_recent({gone, there});
  page.resize(800, 500);
  page.show();
  page.activateWindow();
  ASSERT_TRUE(QTest::qWaitForWindowActive(&page));
  auto* list = page.findChild<QListWidget*>();
  EXPECT_TRUE(QTest::qWaitFor([&] { return list->item(0)->text().startsWith("gone (not found)"); }));
  const auto click = [&](int row) {
    QTest::mouseClick(list->viewport(), Qt::LeftButton, {}, list->visualItemRect(list->item(row)).center());
  };
  click(0);
  EXPECT_EQ(opened.count(), 0);
  click(1);
  // The second half of a double click opens nothing again.
  QTest::mouseDClick(list->viewport(), Qt::LeftButton, {}, list->visualItemRect(list->item(1)).center());
  QTest::mouseRelease(list->viewport(), Qt::LeftButton, {}, list->visualItemRect(list->item(1)).center());
  EXPECT_EQ(opened.count(), 1);
  list->setFocus();
  QTest::keyClick(list, Qt::Key_Return);
  ASSERT_EQ(opened.count(), 2);
  EXPECT_EQ(opened[1][0].toString(), there);

  QMimeData data;
  data.setUrls({QUrl::fromLocalFile(there)});
  QDragEnterEvent enter(QPoint(5, 5), Qt::CopyAction, &data, Qt::LeftButton, Qt::NoModifier);
  QCoreApplication::sendEvent(&page, &enter);
  EXPECT_TRUE(enter.isAccepted());
  QDropEvent drop(QPointF(5, 5), Qt::CopyAction, &data, Qt::LeftButton, Qt::NoModifier);
  QCoreApplication::sendEvent(&page, &drop);
  EXPECT_EQ(opened.count(), 3);
  data.setUrls({QUrl("https://example.org/lamp.lumi")});
  QDragEnterEvent web(QPoint(5, 5), Qt::CopyAction, &data, Qt::LeftButton, Qt::NoModifier);
  QCoreApplication::sendEvent(&page, &web);
  EXPECT_FALSE(web.isAccepted());
}

TEST(StartPage, ANewScanIsAskedForInADialog) {
  const Files files;
  StartPage page;
  QSignalSpy requested(&page, &StartPage::newScanRequested);
  page.show();
  QTest::mouseClick(button(page, "&New scan…"), Qt::LeftButton);
  auto* dialog = page.findChild<NewScanDialog*>();
  ASSERT_NE(dialog, nullptr);
  dialog->set_scan(files.scan);
  QPushButton* take = button(*dialog, "Set up scan");
  EXPECT_TRUE(QTest::qWaitFor([&] { return take->isEnabled(); }));
  QTest::mouseClick(take, Qt::LeftButton);
  EXPECT_EQ(requested.count(), 1);
}

}  // namespace
}  // namespace lumifield
