#include "app/views/luminaire_model.h"

#include <QSignalSpy>
#include <QTemporaryDir>
#include <QTest>
#include <cmath>
#include <gtest/gtest.h>

#include "app/session/beside.h"
#include "app/views/cell_figures.h"
#include "app/views/cell_view.h"
#include "app/views/image_view.h"

namespace lumifield {
namespace {

LuminaireGeometry geometry() {
  LuminaireGeometry g;
  g.planes.separation_mm = 150;
  g.sampling = {BasisKind::bell, {7.5, 7.5}, 3, 2, {0, 0}};
  g.measurement = {4, 4, {1, 1}, {0, 0}};
  g.channels = {"Y"};
  return g;
}

CellImage image(float value) { return {4, 4, 1, std::vector<float>(16, value), {}, {}}; }

TEST(LuminaireModel, CellsComeWithTheirStateAndTheirDifferenceFromTheirNeighbours) {
  LuminaireModel model;
  model.reset(geometry(), "lamp");
  QSignalSpy changed(&model, &LuminaireModel::cellChanged);
  EXPECT_EQ(model.state({0, 0}), LuminaireModel::State::unmeasured);
  model.set_measuring(CellIndex{0, 0});
  EXPECT_EQ(model.state({0, 0}), LuminaireModel::State::measuring);
  model.set_measuring(std::nullopt);

  CellEntry entry{{0, 0}, "a.exr", 1, "", {}, Quality{}};
  model.put(entry, std::make_shared<CellImage>(image(1)));
  EXPECT_TRUE(std::isnan(model.cell({0, 0})->neighbour_difference));
  EXPECT_EQ(changed.count(), 1) << "at once";
  entry.cell = {0, 1};
  entry.quality->warnings = {"saturated"};
  model.put(entry, std::make_shared<CellImage>(image(3)));
  const auto differ_by = [&](double difference) {
    return QTest::qWaitFor(
        [&] {
          return std::abs(model.cell({0, 0})->neighbour_difference - difference) < 1e-6 &&
                 std::abs(model.cell({0, 1})->neighbour_difference - difference) < 1e-6;
        },
        60'000);
  };
  EXPECT_TRUE(differ_by(0.5));
  EXPECT_GE(changed.count(), 4) << "each cell, and each that has a difference";
  EXPECT_EQ(model.state({0, 0}), LuminaireModel::State::measured);
  EXPECT_EQ(model.state({0, 1}), LuminaireModel::State::warned);
  model.set_waiting({{0, 1}});
  EXPECT_EQ(model.state({0, 1}), LuminaireModel::State::waiting);

  // A cell taken again differs anew, and those of another luminaire have nothing to do with it.
  model.put(entry, std::make_shared<CellImage>(image(1)));
  EXPECT_TRUE(differ_by(0));
  model.put(entry, std::make_shared<CellImage>(image(3)));
  model.reset(geometry(), "other");
  entry.cell = {0, 0};
  model.put(entry, std::make_shared<CellImage>(image(1)));
  ASSERT_TRUE(QTest::qWaitFor([&, before = changed.count()] { return changed.count() > before; }, 60'000));
  EXPECT_TRUE(std::isnan(model.cell({0, 0})->neighbour_difference));
}

TEST(LuminaireModel, LoadsAHalfDatasetAndSaysWhyItCannot) {
  QTemporaryDir folder;
  const std::filesystem::path path = folder.filePath("half.lumi").toStdString();
  Manifest manifest;
  manifest.geometry = geometry();
  manifest.name = "half";
  auto writer = DatasetWriter::create(path, manifest);
  ASSERT_TRUE(writer) << writer.error().message();
  ASSERT_TRUE(writer->add({1, 2}, image(2), {0, 0}));

  LuminaireModel model;
  QSignalSpy loaded(&model, &LuminaireModel::loaded), failed(&model, &LuminaireModel::loadFailed);
  model.load(path);
  ASSERT_TRUE(loaded.wait());
  EXPECT_EQ(model.name(), "half");
  EXPECT_EQ(model.measured(), 1);
  EXPECT_EQ(model.total(), 6);
  EXPECT_EQ(model.cell({1, 2})->image->at(0, 3, 3), 2.0F);

  model.load(path / "none");
  ASSERT_TRUE(failed.wait());
  EXPECT_EQ(model.measured(), 1);  // what was there stays
}

TEST(LuminaireModel, ACellThatCannotBeReadIsDamagedUntilItIsMeasured) {
  QTemporaryDir folder;
  const std::filesystem::path path = folder.filePath("lamp.lumi").toStdString();
  Manifest manifest;
  manifest.geometry = geometry();
  auto writer = DatasetWriter::create(path, manifest);
  ASSERT_TRUE(writer) << writer.error().message();
  const auto entry = writer->add({1, 2}, image(2), {0, 0});
  ASSERT_TRUE(entry);
  ASSERT_TRUE(writer->add({0, 0}, image(1), {0, 0}));
  std::filesystem::resize_file(path / entry->file, 100);

  LuminaireModel model;
  QSignalSpy loaded(&model, &LuminaireModel::loaded);
  model.load(path);
  ASSERT_TRUE(loaded.wait());
  const QStringList notes = loaded[0][1].toStringList();
  EXPECT_EQ(model.state({1, 2}), LuminaireModel::State::damaged);
  EXPECT_EQ(model.state({0, 1}), LuminaireModel::State::unmeasured);
  EXPECT_EQ(model.damaged(), 1);
  EXPECT_TRUE(notes.contains(model.damage({1, 2}))) << qPrintable(model.damage({1, 2}));
  const CellFigures figures(model);
  EXPECT_TRUE(figures.summary({1, 2}).endsWith("damaged: " + model.damage({1, 2})));
  CellView view(model);
  view.show_cell({1, 2});
  const auto* shown = view.findChild<ImageView*>();
  EXPECT_TRUE(shown->placeholder().contains(": damaged: " + model.damage({1, 2})));

  model.put(*entry, std::make_shared<CellImage>(image(2)));
  EXPECT_EQ(model.state({1, 2}), LuminaireModel::State::measured);
  EXPECT_EQ(model.damage({1, 2}), "");
}

TEST(LuminaireModel, ThatGoesAmidALoadLeavesNoThreadBehind) {
  QTemporaryDir folder;
  const std::filesystem::path path = folder.filePath("lamp.lumi").toStdString();
  Manifest manifest;
  manifest.geometry = geometry();
  auto writer = DatasetWriter::create(path, manifest);
  ASSERT_TRUE(writer) << writer.error().message();
  ASSERT_TRUE(writer->add({1, 2}, image(2), {0, 0}));
  bool known = false;
  // A load is so short that few are met under way.
  for (int k = 0; k < 20 || (!known && k < 5000); ++k) {
    LuminaireModel model;
    model.load(path);
    model.load(path / "none");
    known = known || !beside_ended(std::chrono::milliseconds(0));
  }
  EXPECT_TRUE(known) << "to whoever ends the program";
  EXPECT_TRUE(beside_ended(std::chrono::minutes(1)));
}

}  // namespace
}  // namespace lumifield
