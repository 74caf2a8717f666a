#include "luminaire/half_cells.h"

#include <cmath>
#include <fstream>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <set>

#include "luminaire/half_cell_file.h"
#include "tests/support/dataset_folder.h"

namespace lumifield {
namespace {

namespace fs = std::filesystem;
using support::read_text;
using support::write_text;
using testing::HasSubstr;

RawImage frame(std::uint16_t first_dn, double exposure_s) {
  RawImage frame;
  frame.width_px = 5, frame.height_px = 4;
  frame.pattern = SensorPattern::gbrg;
  frame.exposure_s = exposure_s;
  frame.gain = 1.5;
  for (std::size_t k = 0; k < 20; ++k) frame.dn.push_back(static_cast<std::uint16_t>(first_dn + 3000 * k));
  return frame;
}

class HalfCellsTest : public support::TemporaryFolder {
 protected:
  HalfCellsTest() { fs::create_directories(dataset_); }

  HalfCell half(CellIndex cell, std::uint16_t first_dn = 7, int pass = 0, int generation = 1) const {
    HalfCell half{pass, generation, {}};
    half.raw.cell = cell;
    half.raw.passes = {{"positive", {frame(first_dn, 0.1), frame(first_dn, 1.0 / 3)}, {1.0 / 7, -2}, nullptr}};
    half.raw.dark = dark_;
    half.raw.position_error_mm = 0.001;
    half.raw.drift = -1.0 / 300;
    half.raw.reference_dn_per_s = 12345.678;
    return half;
  }
  HalfCells open() {
    auto halves = HalfCells::open(dataset_);
    EXPECT_TRUE(halves) << halves.error().message();
    return std::move(*halves);
  }
  std::set<std::string> files() const {
    std::set<std::string> names;
    std::error_code none;
    for (const auto& each : fs::directory_iterator(dataset_ / "halves", none))
      names.insert(each.path().filename().string());
    return names;
  }

  const fs::path dataset_ = folder_ / "lamp.lumi";
  const fs::path file_ = dataset_ / "halves" / "r01_c12.0.raw";
  std::shared_ptr<const DarkSet> dark_ = std::make_shared<const DarkSet>(DarkSet{{frame(1, 0.1), frame(2, 0.5)}, 3});
};

TEST_F(HalfCellsTest, ReturnsWhatWasStoredAndSharesTheDarkSetOfABlock) {
  HalfCells written = open();
  EXPECT_FALSE(fs::exists(dataset_ / "halves"));
  ASSERT_TRUE(written.add(half({1, 12})));
  ASSERT_TRUE(written.add(half({0, 3}, 9, 1, 4)));
  EXPECT_EQ(files().size(), 3U);  // one dark set

  HalfCells halves = open();
  EXPECT_EQ(halves.size(), 2U);
  EXPECT_TRUE(halves.holds({1, 12}, 0));
  EXPECT_FALSE(halves.holds({1, 12}, 1));
  EXPECT_EQ(halves.generation({0, 3}, 1), 4);
  EXPECT_EQ(halves.generation({0, 3}, 0), 0);
  EXPECT_EQ(halves.cells(0), std::vector<CellIndex>({{1, 12}}));
  const auto one = halves.read({1, 12}, 0), other = halves.read({0, 3}, 1);
  ASSERT_TRUE(one) << one.error().message();
  ASSERT_TRUE(other) << other.error().message();
  const HalfCell stored = half({1, 12});
  ASSERT_EQ(one->raw.passes.size(), 1U);
  EXPECT_EQ(one->raw.passes[0].stage_mm, stored.raw.passes[0].stage_mm);
  EXPECT_EQ(one->raw.drift, stored.raw.drift);
  EXPECT_EQ(one->raw.position_error_mm, stored.raw.position_error_mm);
  EXPECT_EQ(one->raw.reference_dn_per_s, stored.raw.reference_dn_per_s);
  EXPECT_EQ(one->raw.dark, other->raw.dark);
  EXPECT_EQ(one->raw.dark->block, 3);
  for (const auto& [read, written_bracket] : {std::pair{&one->raw.passes[0].bracket, &stored.raw.passes[0].bracket},
                                              std::pair{&one->raw.dark->bracket, &dark_->bracket}}) {
    ASSERT_EQ(read->size(), 2U);
    for (std::size_t k = 0; k < 2; ++k) {
      EXPECT_EQ((*read)[k].dn, (*written_bracket)[k].dn);
      EXPECT_EQ((*read)[k].exposure_s, (*written_bracket)[k].exposure_s);
      EXPECT_EQ((*read)[k].gain, 1.5);
      EXPECT_EQ((*read)[k].bits, 12);
      EXPECT_EQ((*read)[k].pattern, SensorPattern::gbrg);
    }
  }
}

TEST_F(HalfCellsTest, AReferenceThatWasNotReadStaysUnread) {
  HalfCells halves = open();
  HalfCell unread = half({1, 12});
  unread.raw.reference_dn_per_s = std::numeric_limits<double>::quiet_NaN();
  ASSERT_TRUE(halves.add(unread));
  EXPECT_TRUE(std::isnan(halves.read({1, 12}, 0)->raw.reference_dn_per_s));
}

TEST_F(HalfCellsTest, OneTakenAgainReplacesTheOneBefore) {
  HalfCells halves = open();
  ASSERT_TRUE(halves.add(half({1, 12}, 7)));
  ASSERT_TRUE(halves.add(half({1, 12}, 8, 0, 2)));
  HalfCells again = open();
  EXPECT_EQ(again.size(), 1U);
  EXPECT_EQ(again.generation({1, 12}, 0), 2);
  EXPECT_EQ(again.read({1, 12}, 0)->raw.passes[0].bracket[0].dn[0], 8);
}

TEST_F(HalfCellsTest, EveryDamageIsFoundAndDoesNotCount) {
  {
    HalfCells halves = open();
    ASSERT_TRUE(halves.add(half({1, 12})));
    ASSERT_TRUE(halves.add(half({0, 0})));
  }
  const std::string sound = read_text(file_);
  for (std::size_t at = 0; at < sound.size(); at += 13) {
    std::string damaged = sound;
    damaged[at] = static_cast<char>(damaged[at] ^ 1);
    write_text(file_, damaged);
    HalfCells halves = open();
    EXPECT_EQ(halves.size(), 1U) << at;
    ASSERT_EQ(halves.notes().size(), 1U);
    EXPECT_THAT(halves.notes()[0], HasSubstr("r01_c12.0.raw"));
  }
  for (const std::size_t length : {std::size_t{0}, std::size_t{64}, std::size_t{65}, sound.size() - 1}) {
    write_text(file_, sound.substr(0, length));
    EXPECT_FALSE(open().holds({1, 12}, 0)) << length;
  }
  write_text(file_, sound);
  EXPECT_EQ(open().size(), 2U);
  // Without its dark set it cannot be developed.
  for (const std::string& name : files())
    if (name.starts_with("dark")) fs::remove(dataset_ / "halves" / name);
  EXPECT_EQ(open().size(), 0U);
}

TEST_F(HalfCellsTest, AFileUnderAnotherCellsNameIsRefused) {
  HalfCells halves = open();
  ASSERT_TRUE(halves.add(half({1, 12})));
  fs::copy_file(file_, dataset_ / "halves" / "r01_c13.0.raw");
  HalfCells again = open();
  EXPECT_EQ(again.size(), 1U);
  EXPECT_THAT(again.notes(), testing::ElementsAre(HasSubstr("is that of another cell or pass")));
}

TEST_F(HalfCellsTest, SizesAreCheckedBeforeMemoryIsTaken) {
  // A header that promises more than there is, under a checksum of its own.
  const auto sealed = [](const std::string& rest) { return sha256_hex(rest) + "\n" + rest; };
  const std::string frames =
      R"({"width_px":16384,"height_px":16384,"bits":12,"pattern":"mono","exposure_s":1,"gain":0})";
  std::string many = frames;
  for (int k = 0; k < 63; ++k) many += "," + frames;
  const std::string header = R"({"format":"lumifield-dark-set","version":1,"block":0,"frames":[)";
  EXPECT_THAT(decode_dark_set(sealed(header + many + "]}\n"), "dark").error().message(), HasSubstr("its header says"));
  for (int k = 0; k < 3; ++k) many += "," + frames;
  EXPECT_THAT(decode_dark_set(sealed(header + many + "]}\n"), "dark").error().message(), HasSubstr("frames: has 67"));
  EXPECT_THAT(decode_dark_set(sealed("{}\n"), "dark").error().message(), HasSubstr("format"));
  EXPECT_THAT(decode_half_cell(sealed(header + frames + "]}\n"), "half").error().message(), HasSubstr("format"));
}

TEST_F(HalfCellsTest, WhatIsPartOfAWholeCellIsRemoved) {
  HalfCells halves = open();
  ASSERT_TRUE(halves.add(half({1, 12}, 7, 0, 1)));
  ASSERT_TRUE(halves.add(half({0, 3}, 7, 0, 2)));
  dark_ = std::make_shared<const DarkSet>(DarkSet{{frame(5, 0.1)}, 4});
  ASSERT_TRUE(halves.add(half({0, 4}, 7, 0, 1)));
  write_text(dataset_ / "halves" / "r00_c00.0.raw.tmp", "torn");
  write_text(dataset_ / "halves" / "r00_c04.1.raw", "damaged");
  Manifest manifest;
  for (const CellIndex cell : {CellIndex{1, 12}, CellIndex{0, 3}, CellIndex{0, 4}}) {
    manifest.cells.push_back({});
    manifest.cells.back().cell = cell;
  }
  ASSERT_TRUE(halves.remove_stale(manifest));
  // The generation after the stored one is still on its way.
  EXPECT_EQ(open().cells(0), std::vector<CellIndex>({{0, 3}}));
  EXPECT_EQ(files().size(), 2U);
  manifest.cells[1].generation = 2;
  ASSERT_TRUE(halves.remove_stale(manifest));
  EXPECT_FALSE(fs::exists(dataset_ / "halves"));
  ASSERT_TRUE(halves.remove_stale(manifest));
}

TEST_F(HalfCellsTest, WhatCouldNotBeReadStaysWithItsDarkSet) {
  {
    HalfCells halves = open();
    ASSERT_TRUE(halves.add(half({1, 12}, 7, 0, 1)));
  }
  const std::set<std::string> before = files();
  const auto dark = std::ranges::find_if(before, [](const std::string& name) { return name.starts_with("dark."); });
  ASSERT_NE(dark, before.end());
  const fs::path file = dataset_ / "halves" / *dark, aside = dataset_ / "aside";
  fs::rename(file, aside);
  fs::create_directory(file);  // reading it fails
  HalfCells halves = open();
  EXPECT_EQ(halves.size(), 0U);
  EXPECT_EQ(halves.notes().size(), 1U);
  ASSERT_TRUE(halves.remove_stale(Manifest()));
  EXPECT_EQ(files(), before);
  fs::remove(file);
  fs::rename(aside, file);
  EXPECT_EQ(open().size(), 1U);
}

TEST_F(HalfCellsTest, ADiskThatRefusesLeavesTheHalvesThatWereThere) {
  HalfCells halves = open();
  ASSERT_TRUE(halves.add(half({1, 12})));
  fs::create_directory(dataset_ / "halves" / "r00_c00.0.raw");
  const Status refused = halves.add(half({0, 0}));
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message(), HasSubstr("cell (0, 0), half"));
  EXPECT_FALSE(halves.holds({0, 0}, 0));
  EXPECT_TRUE(halves.read({1, 12}, 0));
}

}  // namespace
}  // namespace lumifield
