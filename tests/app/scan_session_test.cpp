#include "app/session/scan_session.h"

#include <fstream>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>
#include <unistd.h>

#include "app/session/dataset_folder.h"
#include "app/session/precedent.h"
#include "app/session/preview_memory.h"
#include "app/session/provenance.h"
#include "calibration/develop.h"
#include "renderer/methods/table_memory.h"
#include "tests/support/double_bench.h"
#include "tests/support/small_bench.h"

namespace lumifield {
namespace {

using testing::HasSubstr;
namespace fs = std::filesystem;

/// A bench that passes every check before anything moves, but has no camera.
class ScanSessionTest : public testing::Test {
 protected:
  ScanSessionTest() {
    fs::remove_all(folder_);
    request_.bench = test::developed_bench();
    request_.bench.camera.kind = "none";
    request_.bench.sensor = {240, 2.0, 5, 4000, {20000}, "2024-05-01", "synthetic"};
    request_.plan = test::developed_plan();
    request_.out = folder_;
  }
  ~ScanSessionTest() override { fs::remove_all(folder_); }

  /// A dataset with one cell, or all, as an earlier scan left it: with a journal, or closed.
  void scan_before(bool all = false, bool close = false) {
    Manifest manifest;
    manifest.geometry = luminaire_geometry(request_.bench, request_.plan);
    manifest.provenance_json = provenance_json("{}", request_, "2026-01-31T12:34:56Z", {}, nullptr);
    auto writer = DatasetWriter::create(folder_, std::move(manifest));
    ASSERT_TRUE(writer) << writer.error().message();
    CellImage image;
    image.width_px = 24, image.height_px = 18, image.channels = 1;
    image.value.assign(image.plane(), 1);
    const Sampling& sampling = writer->manifest().geometry.sampling;
    for (int k = 0; k < sampling.cells(); ++k)
      if (all || sampling.index(k) == CellIndex{0, 1}) {
        ASSERT_TRUE(writer->add(sampling.index(k), image, {0, 0}));
      }
    if (close) {
      ASSERT_TRUE(writer->close());
    }
    request_.resume = true;
  }
  std::map<fs::path, std::string> bytes() const {
    std::map<fs::path, std::string> files;
    for (const auto& entry : fs::recursive_directory_iterator(folder_)) {
      std::ostringstream text;
      if (entry.is_regular_file()) text << std::ifstream(entry.path(), std::ios::binary).rdbuf();
      files[entry.path()] = text.str();
    }
    return files;
  }
  Error error_of_scan() {
    auto session = ScanSession::start(request_);
    if (!session) return session.error();
    while ((*session)->next_event()) {
    }
    auto summary = (*session)->wait();
    return summary ? Error{} : summary.error();
  }

  fs::path folder_ = fs::path(testing::TempDir()) / ("session_" + std::to_string(getpid()) + ".lumi");
  ScanRequest request_;
};

TEST_F(ScanSessionTest, ANewDatasetWithoutCellsIsRemoved) {
  EXPECT_EQ(error_of_scan().where, "camera.kind");
  EXPECT_FALSE(fs::exists(folder_));
}

TEST_F(ScanSessionTest, AResumedDatasetIsLeftAsItIsWhenTheCameraDoesNotOpen) {
  scan_before();
  const auto before = bytes();
  EXPECT_EQ(error_of_scan().where, "camera.kind");
  EXPECT_EQ(bytes(), before);
}

TEST_F(ScanSessionTest, AFrameOfTheWrongSizeIsTheOneCauseThatIsTold) {
  test::DoubleBench doubles(80, 60);
  request_.devices = doubles.devices();
  auto session = ScanSession::start(request_);
  ASSERT_TRUE(session) << session.error().message();
  std::vector<std::string> notices;
  while (auto event = (*session)->next_event())
    if (const auto* notice = std::get_if<Notice>(&*event)) notices.push_back(notice->text);
  const auto summary = (*session)->wait();
  ASSERT_FALSE(summary);
  EXPECT_THAT(summary.error().message(),
              testing::HasSubstr("gives pictures of 80x60 px, but the bench's camera_model is of "));
  EXPECT_THAT(notices, testing::IsEmpty());
  EXPECT_EQ((*session)->kept().cells, 0);
}

TEST_F(ScanSessionTest, WhatIsKeptIsToldAfterAScanThatFailed) {
  scan_before();
  test::DoubleBench doubles(160, 120);
  doubles.trip_stage_after(7);  // dark set, reference cell, two cells of two passes
  request_.devices = doubles.devices();
  auto session = ScanSession::start(request_);
  ASSERT_TRUE(session) << session.error().message();
  while ((*session)->next_event()) {
  }
  EXPECT_FALSE((*session)->wait());
  EXPECT_EQ((*session)->kept().cells, 1 + 2);
  EXPECT_EQ((*session)->kept().total, 6);
}

TEST_F(ScanSessionTest, RefusesToResumeWhatIsNotThere) {
  request_.resume = true;
  const Error error = error_of_scan();
  EXPECT_EQ(error.what, "there is no dataset to go on with");
  EXPECT_EQ(error.where, folder_.string());
  EXPECT_THAT(error.remedy, HasSubstr("leave out --resume"));
  EXPECT_FALSE(fs::exists(folder_));
}

TEST_F(ScanSessionTest, ACompleteDatasetIsLeftAsItIsAndSaidToBeComplete) {
  scan_before(true, true);
  const auto before = bytes();
  const auto written = fs::last_write_time(folder_ / "luminaire.json");
  request_.preview.emplace();
  auto session = ScanSession::start(request_);
  ASSERT_TRUE(session) << session.error().message();
  std::vector<std::string> notices;
  while (auto event = (*session)->next_event())
    if (const auto* notice = std::get_if<Notice>(&*event)) notices.push_back(notice->text);
  const auto summary = (*session)->wait();
  ASSERT_TRUE(summary) << summary.error().message();
  EXPECT_TRUE(summary->nothing_left());
  EXPECT_EQ(summary->cells_before, summary->coverage.total);
  EXPECT_THAT(notices, testing::Contains(HasSubstr("cells are there: nothing is left to measure")));
  EXPECT_EQ(bytes(), before);
  EXPECT_EQ(fs::last_write_time(folder_ / "luminaire.json"), written);
}

TEST_F(ScanSessionTest, ACompleteDatasetThatWasNotClosedIsClosed) {
  scan_before(true);
  ASSERT_TRUE(fs::exists(folder_ / "journal.jsonl"));
  EXPECT_EQ(error_of_scan().what, "");
  EXPECT_FALSE(fs::exists(folder_ / "journal.jsonl"));
  const auto index = read_dataset_index(folder_);
  ASSERT_TRUE(index) << index.error().message();
  EXPECT_EQ(static_cast<int>(index->manifest.cells.size()), index->manifest.geometry.sampling.cells());
}

TEST_F(ScanSessionTest, AResumedDatasetIsLeftAsItIsWhenThePreviewFails) {
  scan_before();
  const auto before = bytes();
  request_.preview.emplace();
  EXPECT_NE(error_of_scan().what, "");
  EXPECT_EQ(bytes(), before);
}

TEST_F(ScanSessionTest, AResumedDatasetWithoutAReadableCellIsKept) {
  scan_before();
  fs::path cell;
  for (const auto& entry : fs::directory_iterator(folder_ / "cells")) cell = entry.path();
  fs::resize_file(cell, fs::file_size(cell) / 2);
  const auto before = bytes();
  EXPECT_EQ(error_of_scan().where, "camera.kind");
  EXPECT_EQ(bytes(), before);
}

TEST_F(ScanSessionTest, RefusesToResumeWithAnotherMeasurement) {
  scan_before();
  const auto before = bytes();
  const auto refuses = [&](const char* key) {
    const Error error = error_of_scan();
    EXPECT_THAT(error.where, HasSubstr(key)) << error.message();
    EXPECT_THAT(error.remedy, HasSubstr("resume with")) << error.message();
    EXPECT_EQ(bytes(), before);
  };
  const ScanRequest same = request_;
  request_.bench.sensor.responsivity = {20001};
  refuses("bench: sensor.responsivity.value[0]");
  request_ = same;
  request_.bench.stage_to_luminaire.origin_mm.y() = 0.01;
  refuses("bench: stage_to_luminaire.origin_mm[1]");
  request_ = same;
  request_.bench.camera.gain = 6;
  refuses("bench: camera.gain");
  request_ = same;
  request_.plan.exposures_s.push_back(0.1);
  refuses("plan: exposures_s[3]");
}

TEST_F(ScanSessionTest, AddressesNamesAndPatienceMayChange) {
  const std::string record = provenance_json("{}", request_, "2026-01-31T12:34:56Z", {}, nullptr);
  request_.bench.name = "b", request_.bench.camera.address = "10.0.0.9", request_.bench.stage.path = "/dev/ttyACM1";
  request_.bench.tolerance_mm = 0.5, request_.bench.filter.passes[0].name = "p", request_.plan.settle_s = 3;
  request_.bench.sensor.responsivity_date = "2025-01-01", request_.plan.limits.median_snr = 1;
  request_.plan.exposure_limits_s = {1e-5, 10};
  const auto note = check_same_measurement(record, request_.bench, request_.plan);
  ASSERT_TRUE(note) << note.error().message();
  EXPECT_EQ(*note, "");
  EXPECT_NE(check_same_measurement("{}", request_.bench, request_.plan).value(), "");
}

TEST_F(ScanSessionTest, WhatARecordCouldNotSayYetIsAsItWasThen) {
  request_.bench.camera.kind = "aravis";
  request_.bench.camera.address = request_.bench.stage.path = "as named";
  auto record = nlohmann::json::parse(provenance_json("{}", request_, "2026-01-31T12:34:56Z", {}, nullptr));
  nlohmann::json& bench = record["scans"][0]["bench"];
  std::size_t gone = 0;
  for (const char* later : {"width_px", "height_px", "packet_delay_us", "binning"})
    gone += bench["camera"].erase(later);
  ASSERT_EQ(gone, 4U);
  ASSERT_EQ(bench["filter"].erase("change"), 1U);
  const auto note = check_same_measurement(record.dump(), request_.bench, request_.plan);
  ASSERT_TRUE(note) << note.error().message();
  request_.bench.camera.width_px = 640;
  EXPECT_FALSE(check_same_measurement(record.dump(), request_.bench, request_.plan));
}

TEST_F(ScanSessionTest, ProvenanceHasAnEndOnlyOnceThereIsOne) {
  const std::string begun = provenance_json("{}", request_, "2026-01-31T12:34:56Z", {}, nullptr);
  EXPECT_THAT(begun, testing::Not(testing::AnyOf(HasSubstr("\"ended\""), HasSubstr("timing_s"))));
  EXPECT_FALSE(first_reading(begun));
  EXPECT_EQ(first_reading(provenance_json("{}", request_, "now", {{0, 99.5, 0, 0.002}}, nullptr))->exposure_s, 0.002);
  ScanSummary summary;
  summary.references = {{0, 1234.5, 0, 0.008}, {6, 1300, 0.05, 0.008}};
  summary.camera = "odd \xff name";
  const std::string ended =
      provenance_json(R"({"scans":[{"started":3}],"by":"hand"})", request_, "now", summary.references, &summary);
  const auto json = nlohmann::json::parse(ended);
  EXPECT_EQ(json["by"], "hand");
  EXPECT_EQ(json["scans"].size(), 2U);
  EXPECT_TRUE(json["scans"][1].contains("timing_s"));
  ASSERT_TRUE(first_reading(ended));
  EXPECT_EQ(first_reading(ended)->signal_dn_per_s, 1234.5);
  EXPECT_EQ(first_reading(ended)->exposure_s, 0.008);
}

TEST_F(ScanSessionTest, RemovesNothingThatItDidNotMake) {
  fs::create_directories(folder_ / "cells");
  std::ofstream(folder_ / "luminaire.json") << "{}";
  std::ofstream(folder_ / "cells" / "r00_c00.1.exr") << "photons";
  EXPECT_FALSE(remove_empty_dataset(folder_));
  EXPECT_EQ(bytes().size(), 3U);
  fs::remove(folder_ / "cells" / "r00_c00.1.exr");
  std::ofstream(folder_ / "notes.txt") << "mine";
  EXPECT_FALSE(remove_empty_dataset(folder_));
  EXPECT_EQ(bytes().size(), 3U);
  fs::remove(folder_ / "notes.txt");
  EXPECT_TRUE(remove_empty_dataset(folder_));
  EXPECT_FALSE(fs::exists(folder_));
}

TEST_F(ScanSessionTest, APreviewIsBoundedByMemory) {
  const LuminaireGeometry geometry = luminaire_geometry(request_.bench, request_.plan);
  const double bytes = 6.0 * 24 * 18 * 4;
  EXPECT_TRUE(check_preview_memory(geometry, 2 * bytes));
  EXPECT_FALSE(check_preview_memory(geometry, 2 * bytes - 1));
  EXPECT_GT(host_memory_bytes(), 1e8);
}

}  // namespace
}  // namespace lumifield
