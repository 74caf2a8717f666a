#include <cmath>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "luminaire/dataset.h"
#include "tests/support/dataset_folder.h"
#include "tests/support/exr_file.h"

namespace lumifield {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;
using support::ExrFile;
using support::write_text;
using testing::HasSubstr;

/// The manifest as its documentation spells it, without the checksum.
constexpr const char* documented = R"json({
  "format": "lumifield-luminaire", "version": 1, "name": "bike light",
  "quantity": "radiance", "unit": "W/(m^2 sr)", "channels": ["R", "G", "B"],
  "planes": { "separation_mm": 150.0 },
  "sampling": { "basis": "bell", "spacing_mm": [7.5, 7.5], "columns": 9, "rows": 7, "center_mm": [0, 0] },
  "measurement": { "width_px": 300, "height_px": 300, "pixel_mm": [1.0, 1.0], "center_mm": [0, 0] },
  "cells": [ { "row": 0, "column": 0, "file": "cells/r00_c00.1.exr", "generation": 1, "stage_mm": [0, 0],
               "quality": { } } ],
  "provenance": { } })json";

/// A dataset that another program wrote to the documentation.
class ForeignDataset : public support::TemporaryFolder {
 protected:
  ForeignDataset() { fs::create_directories(folder_ / "cells"); }

  ExrFile exr(int width, int height, Imf::PixelType type) const {
    ExrFile file(width, height);
    int number = 0;
    for (const char* name : {"B", "G", "R"}) {
      file.channels[name] = type;
      std::vector<float>& plane = file.pixels[name];
      for (int j = 0; j < height; ++j)
        for (int i = 0; i < width; ++i) plane.push_back(static_cast<float>(1000 * number + (i + 3 * j) % 512) / 4);
      ++number;
    }
    return file;
  }
  /// The documented manifest with 5 × 4 pixels, so that tests are quick.
  Json small() const {
    Json json = Json::parse(documented);
    json["measurement"]["width_px"] = 5;
    json["measurement"]["height_px"] = 4;
    return json;
  }
  std::string refusal(const Json& manifest) const {
    write_text(folder_ / "luminaire.json", manifest.dump());
    const Result<Dataset> read = read_dataset(folder_);
    return read ? "accepted" : read.error().message();
  }
  std::string refusal_with(const char* pointer, const Json& value) const {
    Json json = small();
    json[Json::json_pointer(pointer)] = value;
    return refusal(json);
  }
  std::string refusal_of(const ExrFile& file) const {
    file.write(first_);
    return refusal(small());
  }
  fs::path first_ = folder_ / "cells/r00_c00.1.exr";
};

TEST_F(ForeignDataset, OpensTheDocumentedManifest) {
  exr(300, 300, Imf::HALF).write(first_);
  write_text(folder_ / "luminaire.json", documented);
  const Result<Dataset> read = read_dataset(folder_);
  ASSERT_TRUE(read) << read.error().message();
  EXPECT_EQ(read->index.manifest.geometry.quantity, Quantity::radiance);
  EXPECT_EQ(read->light_field.coverage().measured, 1);
  EXPECT_EQ(read->light_field.coverage().total, 63);
  const auto cell = read->light_field.cell({0, 0});
  ASSERT_TRUE(cell);
  EXPECT_EQ(cell->at(0, 7, 5), (2000 + 22) / 4.0f) << "R, column 7, scanline 5";
  EXPECT_EQ(cell->at(2, 299, 299), ((299 + 897) % 512) / 4.0f) << "B, last pixel";
  EXPECT_TRUE(cell->variance.empty());
  EXPECT_TRUE(std::isnan(cell->quality.median_snr));

  const Result<CheckReport> report = check_dataset(folder_);
  ASSERT_TRUE(report);
  EXPECT_THAT(report->problems, testing::IsEmpty());
  EXPECT_THAT(report->notes, testing::ElementsAre(HasSubstr("1 of 1 entries record no sha256")));
}

TEST_F(ForeignDataset, OpensWhatLeavesOutTheOptionalMembers) {
  exr(5, 4, Imf::FLOAT).write(folder_ / "my image.exr");
  Json json = small();
  json["cells"] = Json::array({{{"row", 6}, {"column", 8}, {"file", "my image.exr"}, {"colour", "unknown member"}}});
  EXPECT_EQ(refusal(json), "accepted");
  EXPECT_EQ(read_dataset(folder_)->light_field.cell({6, 8})->at(1, 4, 3), (1000 + 13) / 4.0f);
  Result<DatasetWriter> writer = DatasetWriter::resume(folder_, read_dataset(folder_)->index.manifest.geometry);
  ASSERT_TRUE(writer) << writer.error().message();
  EXPECT_EQ(writer->manifest().cells.size(), 1u);
  EXPECT_TRUE(writer->close());
  EXPECT_TRUE(fs::exists(folder_ / "my image.exr"));
}

TEST_F(ForeignDataset, ReadsEveryWayToWriteAnImage) {
  ExrFile file = exr(5, 4, Imf::FLOAT);
  file.pixels["Z"] = file.pixels["B"];
  file.channels["Z"] = Imf::HALF;
  file.channels["G"] = Imf::HALF;
  for (const bool tiled : {false, true})
    for (const auto order : {Imf::INCREASING_Y, Imf::DECREASING_Y})
      for (const auto compression :
           {Imf::NO_COMPRESSION, Imf::RLE_COMPRESSION, Imf::ZIPS_COMPRESSION, Imf::PIZ_COMPRESSION}) {
        file.tiled = tiled;
        file.line_order = order;
        file.compression = compression;
        ASSERT_EQ(refusal_of(file), "accepted") << tiled << order << compression;
        const auto cell = read_dataset(folder_)->light_field.cell({0, 0});
        EXPECT_EQ(cell->at(0, 2, 3), (2000 + 11) / 4.0f);
        EXPECT_EQ(cell->at(1, 0, 1), (1000 + 3) / 4.0f);
      }
}

TEST_F(ForeignDataset, ReadsVarianceWhenAllChannelsHaveIt) {
  ExrFile file = exr(5, 4, Imf::FLOAT);
  for (const char* name : {"R", "G"}) {
    file.channels[std::string(name) + ".variance"] = Imf::HALF;
    file.pixels[std::string(name) + ".variance"] = std::vector<float>(20, 0.5f);
  }
  EXPECT_THAT(refusal_of(file), HasSubstr("cell (0, 0): has the variance of some channels only"));
  file.channels["B.variance"] = Imf::FLOAT;
  file.pixels["B.variance"] = std::vector<float>(20, 0.25f);
  EXPECT_EQ(refusal_of(file), "accepted");
  EXPECT_EQ(read_dataset(folder_)->light_field.cell({0, 0})->variance[45], 0.25f);
  file.pixels["B.variance"][6] = -1;
  EXPECT_THAT(refusal_of(file), HasSubstr("channel B.variance: pixel (1, 1): holds NaN, Inf or a negative number"));
}

TEST_F(ForeignDataset, AcceptsAnOffsetOfBothWindowsAndRefusesACrop) {
  ExrFile file = exr(5, 4, Imf::FLOAT);
  file.data_window = file.display_window = {{-7, 11}, {-3, 14}};
  EXPECT_EQ(refusal_of(file), "accepted");
  EXPECT_EQ(read_dataset(folder_)->light_field.cell({0, 0})->at(0, 2, 3), (2000 + 11) / 4.0f);
  file.display_window = {{0, 0}, {4, 3}};
  EXPECT_THAT(refusal_of(file), HasSubstr("has a data window other than its display window"));
}

TEST_F(ForeignDataset, RefusesDamagedImagesNamingFileCellAndPixel) {
  const std::string where = "cells/r00_c00.1.exr: cell (0, 0): ";
  EXPECT_THAT(refusal_of(exr(4, 4, Imf::FLOAT)), HasSubstr(where + "is an image of 4 x 4 pixels, not of 5 x 4"));
  ExrFile file = exr(5, 4, Imf::FLOAT);
  file.channels.erase("G");
  EXPECT_THAT(refusal_of(file), HasSubstr(where + "has no channel G"));
  file.channels["G"] = Imf::UINT;
  EXPECT_THAT(refusal_of(file), HasSubstr(where + "has channel G neither HALF nor FLOAT"));
  file.channels["G"] = Imf::HALF;
  file.pixels["G"][13] = 1e6f;
  EXPECT_THAT(refusal_of(file), HasSubstr(where + "channel G: pixel (3, 2): holds NaN or Inf"));
  file.channels["G"] = Imf::FLOAT;
  EXPECT_EQ(refusal_of(file), "accepted");
  file.pixels["R"].assign(20, NAN);
  EXPECT_THAT(refusal_of(file), HasSubstr(where + "channel R: pixel (0, 0): holds NaN or Inf"));
}

TEST_F(ForeignDataset, RefusesAnImageCutAnywhere) {
  for (const auto compression : {Imf::NO_COMPRESSION, Imf::ZIP_COMPRESSION}) {
    ExrFile file = exr(5, 4, Imf::FLOAT);
    file.compression = compression;
    ASSERT_EQ(refusal_of(file), "accepted");
    const std::string whole = support::read_text(first_);
    for (std::size_t length = 0; length < whole.size(); ++length) {
      write_text(first_, whole.substr(0, length));
      const Result<Dataset> read = read_dataset(folder_);
      ASSERT_FALSE(read) << length;
      ASSERT_THAT(read.error().message(), HasSubstr("cells/r00_c00.1.exr: cell (0, 0): "));
    }
  }
}

TEST_F(ForeignDataset, RefusesAHeaderWhoseAttributesClaimOtherLengths) {
  ExrFile file = exr(5, 4, Imf::FLOAT);
  ASSERT_EQ(refusal_of(file), "accepted");
  const std::string whole = support::read_text(first_);
  // The length stands before the value: "name\0type\0" and four bytes.
  for (const std::string_view attribute :
       {std::string_view("channels\0chlist\0", 16), std::string_view("dataWindow\0box2i\0", 17),
        std::string_view("lineOrder\0lineOrder\0", 20)}) {
    const std::size_t at = whole.find(attribute);
    ASSERT_NE(at, std::string::npos);
    for (const char change : {'\1', '\x7f'}) {
      std::string damaged = whole;
      damaged[at + attribute.size() + (change == '\1' ? 0 : 3)] ^= change;
      write_text(first_, damaged);
      EXPECT_THAT(read_dataset(folder_).error().message(), HasSubstr("ends within its header, or has a damaged one"));
    }
  }
}

TEST_F(ForeignDataset, NamesWhatIsWrongInTheManifest) {
  exr(5, 4, Imf::FLOAT).write(first_);
  ASSERT_EQ(refusal(small()), "accepted");
  EXPECT_THAT(refusal_with("/format", "lumifield-scene"), HasSubstr("luminaire.json: format: is not"));
  EXPECT_THAT(refusal_with("/version", 2), HasSubstr("version: is a version this program does not know"));
  EXPECT_THAT(refusal_with("/unit", "cd/m^2"), HasSubstr("unit: is not the unit of radiance"));
  EXPECT_THAT(refusal_with("/channels", Json({"B", "G", "R"})), HasSubstr("channels: is neither"));
  EXPECT_THAT(refusal_with("/sampling/basis", "gauss"), HasSubstr("sampling.basis: \"gauss\" is not known"));
  EXPECT_THAT(refusal_with("/sampling/columns", 1'000'000'000), HasSubstr("sampling.columns: is out of range"));
  EXPECT_THAT(refusal_with("/sampling/spacing_mm", Json({7.5, nullptr})),
              HasSubstr("sampling.spacing_mm[1]: has the wrong"));
  EXPECT_THAT(refusal_with("/measurement/width_px", 16385), HasSubstr("measurement.width_px: is out of range"));
  EXPECT_THAT(refusal_with("/cells/0/row", 7), HasSubstr("cells[0].row: is out of range (7)"));
  EXPECT_THAT(refusal_with("/cells/0/generation", 0), HasSubstr("cells[0].generation"));
  EXPECT_THAT(refusal_with("/cells/0/sha256", "…"), HasSubstr("cells[0].sha256: is no SHA-256"));
  EXPECT_THAT(refusal_with("/cells/0/sha256", std::string(64, '0')), HasSubstr("its SHA-256 differs"));
  EXPECT_THAT(refusal_with("/cells/0/quality/drift", "no"), HasSubstr("cells[0].quality.drift: has the wrong type"));
  EXPECT_THAT(refusal_with("/cells/0/quality/saturated_share", 2), HasSubstr("saturated_share: is out of range (2)"));
  EXPECT_THAT(refusal_with("/provenance", "me"), HasSubstr("provenance: has the wrong type"));
  Json billion = small();
  billion["sampling"]["columns"] = billion["sampling"]["rows"] = 31623;
  EXPECT_THAT(refusal(billion), HasSubstr("sampling: is a grid of 1000014129 cells"));
}

TEST_F(ForeignDataset, KeepsFilesInsideTheFolder) {
  exr(5, 4, Imf::FLOAT).write(first_);
  EXPECT_THAT(refusal_with("/cells/0/file", "/etc/passwd"), HasSubstr("cells[0].file: is an absolute path"));
  EXPECT_THAT(refusal_with("/cells/0/file", "cells/../../x.exr"), HasSubstr("cells[0].file: leads out of the folder"));
  fs::create_symlink("/etc/passwd", folder_ / "cells/link.exr");
  EXPECT_THAT(refusal_with("/cells/0/file", "cells/link.exr"), HasSubstr("is a link that leads out of the folder"));
  EXPECT_THAT(refusal_with("/cells/0/file", "cells"), HasSubstr("is no regular file"));
}

TEST_F(ForeignDataset, ClosingRemovesNothingOutsideTheFolder) {
  const fs::path outside = folder_ / "outside";
  const fs::path inside = folder_ / "lamp.lumi";
  fs::create_directories(outside);
  fs::create_directories(inside / "cells");
  exr(5, 4, Imf::FLOAT).write(outside / "r00_c00.1.exr");
  fs::copy(outside / "r00_c00.1.exr", inside / "cells/a.exr");
  fs::create_directory_symlink(outside, inside / "link");
  Json json = small();
  json["cells"] = Json::array({{{"row", 0}, {"column", 0}, {"file", "link/r00_c00.1.exr"}},
                               {{"row", 0}, {"column", 0}, {"file", "cells/a.exr"}}});
  write_text(inside / "luminaire.json", json.dump());
  Result<DatasetWriter> writer = DatasetWriter::resume(inside, read_dataset(inside)->index.manifest.geometry);
  ASSERT_TRUE(writer);
  ASSERT_TRUE(writer->close());
  EXPECT_TRUE(fs::exists(outside / "r00_c00.1.exr"));
  EXPECT_TRUE(read_dataset(inside));
}

}  // namespace
}  // namespace lumifield
