#include "luminaire/dataset.h"

#include <cmath>
#include <fstream>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <limits>
#include <nlohmann/json.hpp>

#include "tests/support/dataset_folder.h"

namespace lumifield {
namespace {

namespace fs = std::filesystem;
using support::cell_image;
using support::read_text;
using support::write_text;
using testing::HasSubstr;

class DatasetOnDisk : public support::TemporaryFolder {
 protected:
  DatasetWriter create() {
    Result<DatasetWriter> writer = DatasetWriter::create(dataset_, {"bike light", geometry_, {}, R"({"by":"test"})"});
    EXPECT_TRUE(writer) << writer.error().message();
    return std::move(*writer);
  }
  CellEntry add(DatasetWriter& writer, CellIndex cell, unsigned seed) {
    const Result<CellEntry> entry = writer.add(cell, cell_image(geometry_, seed), {cell.column * 7.5, cell.row * 7.5});
    EXPECT_TRUE(entry) << entry.error().message();
    return *entry;
  }
  LuminaireGeometry geometry_ = support::geometry(3, 2, 5, 4, {"R", "G", "B"});
  fs::path dataset_ = folder_ / "lamp.lumi";
};

TEST_F(DatasetOnDisk, ReturnsWhatWasWrittenBeforeAndAfterClosing) {
  DatasetWriter writer = create();
  add(writer, {1, 2}, 1);
  add(writer, {0, 1}, 2);
  for (const bool closed : {false, true}) {
    if (closed) {
      ASSERT_TRUE(writer.close());
    }
    EXPECT_EQ(fs::exists(dataset_ / "journal.jsonl"), !closed);
    const Result<Dataset> read = read_dataset(dataset_);
    ASSERT_TRUE(read) << read.error().message();
    EXPECT_THAT(read->index.notes, testing::IsEmpty());
    EXPECT_EQ(read->light_field.coverage().measured, 2);
    EXPECT_EQ(read->index.manifest.name, "bike light");
    EXPECT_EQ(read->index.manifest.provenance_json, R"({"by":"test"})");
    const CellImage written = cell_image(geometry_, 1);
    const auto image = read->light_field.cell({1, 2});
    ASSERT_TRUE(image);
    EXPECT_EQ(image->value, written.value);
    EXPECT_EQ(image->variance, written.variance);
    EXPECT_EQ(image->quality.median_snr, written.quality.median_snr);
    EXPECT_TRUE(std::isnan(image->quality.drift));
    EXPECT_EQ(image->quality.warnings, written.quality.warnings);
    EXPECT_EQ(image->quality.exposures_s, written.quality.exposures_s);
    EXPECT_EQ(read->index.manifest.cells[0].cell, (CellIndex{0, 1}));
    EXPECT_EQ(read->index.manifest.cells[0].stage_mm, Vec2(7.5, 0));
  }
}

TEST_F(DatasetOnDisk, KeepsImagesWithoutVariance) {
  DatasetWriter writer = create();
  CellImage image = cell_image(geometry_, 1);
  image.variance.clear();
  ASSERT_TRUE(writer.add({0, 0}, image, {0, 0}));
  const auto read = read_dataset(dataset_);
  ASSERT_TRUE(read) << read.error().message();
  EXPECT_TRUE(read->light_field.cell({0, 0})->variance.empty());
}

TEST_F(DatasetOnDisk, WritesNotDeterminedAsNull) {
  DatasetWriter writer = create();
  add(writer, {0, 0}, 1);
  EXPECT_THAT(read_text(dataset_ / "journal.jsonl"), HasSubstr(R"("drift":null)"));
  ASSERT_TRUE(writer.close());
  EXPECT_THAT(read_text(dataset_ / "luminaire.json"), HasSubstr(R"("drift":null)"));
}

TEST_F(DatasetOnDisk, TellsExposuresOnlyWhereTheyDifferFromThePlans) {
  DatasetWriter writer = create();
  CellImage image = cell_image(geometry_, 1);
  ASSERT_TRUE(writer.add({0, 0}, image, {0, 0}));
  EXPECT_THAT(read_text(dataset_ / "journal.jsonl"), HasSubstr(R"("exposures_s":{"positive":[0.0005,0.002]})"));
  image.quality.exposures_s.clear();
  ASSERT_TRUE(writer.add({0, 1}, image, {0, 0}));
  ASSERT_TRUE(writer.close());
  const auto index = read_dataset_index(dataset_);
  ASSERT_TRUE(index) << index.error().message();
  EXPECT_EQ(index->manifest.cells[0].quality->exposures_s.size(), 1U);
  EXPECT_TRUE(index->manifest.cells[1].quality->exposures_s.empty());
}

TEST_F(DatasetOnDisk, RefusesExposuresThatAreNone) {
  const auto refusal = [&](const std::string& exposures) {
    const auto entry = parse_journal_line(
        R"({"row":0,"column":0,"file":"a.exr","quality":{"exposures_s":)" + exposures + "}}", geometry_, "line 1");
    return entry ? "accepted" : entry.error().message();
  };
  EXPECT_EQ(refusal(R"({"positive":[0.001,0.004]})"), "accepted");
  EXPECT_THAT(refusal("[0.001]"), HasSubstr("quality.exposures_s"));
  EXPECT_THAT(refusal(R"({"positive":[]})"), HasSubstr("exposures_s.positive: has 0 elements"));
  EXPECT_THAT(refusal(R"({"positive":[0]})"), HasSubstr("exposures_s.positive[0]: is out of range"));
}

TEST_F(DatasetOnDisk, ARetakeIsTheNextGenerationAndClosingRemovesTheOld) {
  DatasetWriter writer = create();
  EXPECT_EQ(add(writer, {0, 0}, 1).file, "cells/r00_c00.1.exr");
  EXPECT_EQ(add(writer, {0, 0}, 2).file, "cells/r00_c00.2.exr");
  EXPECT_TRUE(fs::exists(dataset_ / "cells/r00_c00.1.exr"));
  EXPECT_EQ(read_dataset(dataset_)->light_field.cell({0, 0})->value, cell_image(geometry_, 2).value);
  ASSERT_TRUE(writer.close());
  EXPECT_FALSE(fs::exists(dataset_ / "cells/r00_c00.1.exr"));
  EXPECT_EQ(read_dataset(dataset_)->light_field.cell({0, 0})->value, cell_image(geometry_, 2).value);
  EXPECT_EQ(add(writer, {0, 0}, 3).generation, 3);
  EXPECT_EQ(read_dataset(dataset_)->light_field.cell({0, 0})->value, cell_image(geometry_, 3).value);
}

TEST_F(DatasetOnDisk, IdenticalMeasurementsMakeIdenticalDatasets) {
  std::string files[2];
  for (int k = 0; k < 2; ++k) {
    dataset_ = folder_ / ("lamp" + std::to_string(k) + ".lumi");
    DatasetWriter writer = create();
    // The second scan takes the cells in another order and is resumed halfway.
    add(writer, {k, 0}, static_cast<unsigned>(k));
    if (k == 1) {
      { const DatasetWriter interrupted = std::move(writer); }
      Result<DatasetWriter> resumed = DatasetWriter::resume(dataset_, geometry_);
      ASSERT_TRUE(resumed) << resumed.error().message();
      writer = std::move(*resumed);
    }
    add(writer, {1 - k, 0}, static_cast<unsigned>(1 - k));
    ASSERT_TRUE(writer.close());
    files[k] = support::contents_of(dataset_);
  }
  EXPECT_EQ(files[0], files[1]);
}

TEST_F(DatasetOnDisk, CreateRefusesAnExistingFolder) {
  fs::create_directories(dataset_);
  const auto again = DatasetWriter::create(dataset_, {"x", geometry_, {}, "{}"});
  ASSERT_FALSE(again);
  EXPECT_THAT(again.error().message(),
              HasSubstr("lamp.lumi: exists already; choose another name, or go on with --resume"));
  EXPECT_TRUE(fs::is_empty(dataset_));
  EXPECT_FALSE(DatasetWriter::create(dataset_ / "", {"x", geometry_, {}, "{}"}));
}

TEST_F(DatasetOnDisk, CreateRefusesWhatCouldNotBeReadBack) {
  geometry_.planes.separation_mm = std::numeric_limits<double>::quiet_NaN();
  const auto refused = DatasetWriter::create(dataset_, {"x", geometry_, {}, "{}"});
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message(), HasSubstr("planes.separation_mm"));
  EXPECT_FALSE(fs::exists(dataset_));
}

TEST_F(DatasetOnDisk, CreateSaysWhyItCannotWrite) {
  const auto nowhere = DatasetWriter::create(folder_ / "none" / "lamp.lumi", {"x", geometry_, {}, "{}"});
  ASSERT_FALSE(nowhere);
  EXPECT_THAT(nowhere.error().message(), HasSubstr("No such file or directory; check the path"));
  write_text(folder_ / "file", "");
  EXPECT_THAT(DatasetWriter::create(folder_ / "file" / "lamp.lumi", {"x", geometry_, {}, "{}"}).error().message(),
              HasSubstr("Not a directory"));
}

TEST_F(DatasetOnDisk, AddRefusesBadImagesAndLeavesNothing) {
  DatasetWriter writer = create();
  const auto refusal = [&](CellIndex cell, const CellImage& image) {
    return writer.add(cell, image, {0, 0}).error().message();
  };
  EXPECT_THAT(refusal({2, 0}, cell_image(geometry_, 1)), HasSubstr("cell (2, 0): lies outside the grid"));
  CellImage image = cell_image(geometry_, 1);
  image.value[2 * image.plane() + 7] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THAT(refusal({0, 0}, image), HasSubstr("cell (0, 0): channel B: pixel (2, 1): holds NaN or Inf"));
  image = cell_image(geometry_, 1);
  image.variance[3] = -1;
  EXPECT_THAT(refusal({0, 0}, image), HasSubstr("channel R.variance: pixel (3, 0)"));
  image.variance.resize(7);
  EXPECT_THAT(refusal({0, 0}, image), HasSubstr("another size"));
  image.variance.clear();
  image.value.pop_back();
  EXPECT_THAT(refusal({0, 0}, image), HasSubstr("another size"));
  EXPECT_THAT(writer.add({0, 0}, cell_image(geometry_, 1), {INFINITY, 0}).error().message(), HasSubstr("stage_mm[0]"));
  EXPECT_TRUE(fs::is_empty(dataset_ / "cells"));
  EXPECT_FALSE(fs::exists(dataset_ / "journal.jsonl"));
}

TEST_F(DatasetOnDisk, ResumeNamesTheFirstDifferenceOfGeometry) {
  { create(); }
  LuminaireGeometry other = geometry_;
  other.sampling.columns = 4;
  EXPECT_THAT(DatasetWriter::resume(dataset_, other).error().message(), HasSubstr("its sampling.columns is 3, not 4"));
  other = geometry_;
  other.measurement.pixel_mm.y() = 0.25;
  EXPECT_THAT(DatasetWriter::resume(dataset_, other).error().message(),
              HasSubstr("its measurement.pixel_mm.1 is 1.0, not 0.25"));
  other = geometry_;
  other.channels = {"Y"};
  EXPECT_THAT(DatasetWriter::resume(dataset_, other).error().message(),
              HasSubstr("its channels.0 is \"R\", not \"Y\""));
  other = geometry_;
  other.quantity = Quantity::radiance;
  EXPECT_THAT(DatasetWriter::resume(dataset_, other).error().message(), HasSubstr("its quantity is \"relative\""));
  EXPECT_TRUE(DatasetWriter::resume(dataset_, geometry_));
}

TEST_F(DatasetOnDisk, ResumeRefusesAFolderThatAnotherWriterHolds) {
  {
    const DatasetWriter writer = create();
    EXPECT_THAT(DatasetWriter::resume(dataset_, geometry_).error().message(),
                HasSubstr("is being written by another program"));
  }
  EXPECT_TRUE(DatasetWriter::resume(dataset_, geometry_));
  EXPECT_THAT(DatasetWriter::resume(folder_ / "none", geometry_).error().message(), HasSubstr("No such file"));
}

TEST_F(DatasetOnDisk, CloseRefusesProvenanceThatIsNoObject) {
  DatasetWriter writer = create();
  writer.set_provenance("[1, 2");
  EXPECT_FALSE(writer.close());
  writer.set_provenance(R"({"started": "2024-05-01T12:00:00Z", "bench": {"name": "7"}})");
  ASSERT_TRUE(writer.close());
  EXPECT_THAT(read_dataset(dataset_)->index.manifest.provenance_json, HasSubstr(R"("bench":{"name":"7"})"));
}

TEST_F(DatasetOnDisk, RecordsProvenanceAmidAScan) {
  {
    DatasetWriter writer = create();
    add(writer, {0, 0}, 1);
    ASSERT_TRUE(writer.record_provenance(R"({"by":"now"})"));
    add(writer, {1, 2}, 2);
  }
  const Result<DatasetWriter> resumed = DatasetWriter::resume(dataset_, geometry_);
  ASSERT_TRUE(resumed) << resumed.error().message();
  EXPECT_EQ(resumed->manifest().provenance_json, R"({"by":"now"})");
  EXPECT_EQ(resumed->manifest().cells.size(), 2U);
  EXPECT_THAT(resumed->notes(), testing::IsEmpty());
}

TEST_F(DatasetOnDisk, ADamagedLastGenerationGivesWayToTheOneBefore) {
  DatasetWriter writer = create();
  add(writer, {0, 0}, 1);
  add(writer, {0, 0}, 2);
  const fs::path last = dataset_ / "cells/r00_c00.2.exr";
  const std::string whole = read_text(last);
  std::string flipped = whole;
  flipped.back() = static_cast<char>(flipped.back() ^ 1);
  for (const std::string& damage : {flipped, whole.substr(0, whole.size() / 2), std::string()}) {
    write_text(last, damage);
    const Result<Dataset> read = read_dataset(dataset_);
    ASSERT_TRUE(read) << read.error().message();
    EXPECT_EQ(read->light_field.cell({0, 0})->value, cell_image(geometry_, 1).value);
    ASSERT_EQ(read->index.notes.size(), 1u);
    EXPECT_THAT(read->index.notes[0], HasSubstr("r00_c00.2.exr: cell (0, 0): is not what was written"));
    EXPECT_EQ(check_dataset(dataset_)->problems.size(), 1u);
  }
  fs::remove(last);
  EXPECT_EQ(read_dataset(dataset_)->light_field.cell({0, 0})->value, cell_image(geometry_, 1).value);
  EXPECT_EQ(read_dataset_index(dataset_)->manifest.cells[0].generation, 1);
}

TEST_F(DatasetOnDisk, ClosingNeverRemovesTheLastValidGeneration) {
  {
    DatasetWriter writer = create();
    add(writer, {0, 0}, 1);
    add(writer, {0, 0}, 2);
  }
  write_text(dataset_ / "cells/r00_c00.2.exr", "damaged");
  Result<DatasetWriter> writer = DatasetWriter::resume(dataset_, geometry_);
  ASSERT_TRUE(writer) << writer.error().message();
  EXPECT_EQ(writer->notes().size(), 1u);
  ASSERT_TRUE(writer->close());
  EXPECT_EQ(read_dataset(dataset_)->light_field.cell({0, 0})->value, cell_image(geometry_, 1).value);
}

TEST_F(DatasetOnDisk, ADamagedOnlyGenerationIsAnErrorAndMeasuredAgainOnResume) {
  {
    DatasetWriter writer = create();
    add(writer, {0, 1}, 1);
  }
  const fs::path file = dataset_ / "cells/r00_c01.1.exr";
  fs::resize_file(file, fs::file_size(file) - 1);
  const auto read = read_dataset(dataset_);
  ASSERT_FALSE(read);
  EXPECT_THAT(read.error().message(), HasSubstr("r00_c01.1.exr: cell (0, 1): "));
  Result<DatasetWriter> writer = DatasetWriter::resume(dataset_, geometry_);
  ASSERT_TRUE(writer);
  EXPECT_TRUE(writer->manifest().cells.empty());
  EXPECT_EQ(add(*writer, {0, 1}, 1).generation, 2);
  EXPECT_TRUE(read_dataset(dataset_));
}

TEST_F(DatasetOnDisk, CheckReportsDamageMissingFilesAndExchangedOnes) {
  DatasetWriter writer = create();
  for (int column = 0; column < 3; ++column) add(writer, {0, column}, static_cast<unsigned>(column));
  ASSERT_TRUE(writer.close());
  Result<CheckReport> report = check_dataset(dataset_);
  ASSERT_TRUE(report);
  EXPECT_THAT(report->problems, testing::IsEmpty());
  EXPECT_THAT(report->notes, testing::IsEmpty());
  EXPECT_EQ(report->coverage.measured, 3);
  EXPECT_EQ(report->coverage.missing.size(), 3u);

  fs::remove(dataset_ / "cells/r00_c00.1.exr");
  nlohmann::json manifest = nlohmann::json::parse(read_text(dataset_ / "luminaire.json"));
  std::swap(manifest["cells"][1]["file"], manifest["cells"][2]["file"]);
  std::swap(manifest["cells"][1]["sha256"], manifest["cells"][2]["sha256"]);
  write_text(dataset_ / "luminaire.json", manifest.dump());
  report = check_dataset(dataset_);
  ASSERT_TRUE(report);
  EXPECT_THAT(report->problems, testing::ElementsAre(HasSubstr("No such file"), HasSubstr("names cell (0, 2)"),
                                                     HasSubstr("names cell (0, 1)")));
  EXPECT_EQ(report->coverage.measured, 0);
}

}  // namespace
}  // namespace lumifield
