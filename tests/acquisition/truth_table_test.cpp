#include "acquisition/virtual/truth_table.h"

#include <fstream>
#include <gtest/gtest.h>
#include <sstream>
#include <unistd.h>

namespace lumifield::virtual_bench {
namespace {

class TruthTableTest : public testing::Test {
 protected:
  void SetUp() override { std::filesystem::create_directory(folder_); }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  Status write(const std::string& table) {
    std::ofstream(folder_ / "points.csv") << table;
    return write_truth({}, false, folder_ / "points.csv", folder_ / "truth.csv");
  }
  std::string place(int line) const { return (folder_ / "points.csv").string() + ": line " + std::to_string(line); }

  const std::filesystem::path folder_ =
      std::filesystem::temp_directory_path() / ("lumifield-truth-" + std::to_string(getpid()));
};

TEST_F(TruthTableTest, AddsTheIrradianceToEachLine) {
  ASSERT_TRUE(write("x_mm,y_mm,z_mm,nx,ny,nz,name\n0,0,500,0,0,-1,near\r\n100,-50,800.5,0,0.6,-0.8,far\n"));
  const TruthPoint points[] = {{{0, 0, 500}, {0, 0, -1}}, {{100, -50, 800.5}, {0, 0.6, -0.8}}};
  const auto e = truth({}, false, points);
  char expected[400];
  std::snprintf(expected, sizeof expected,
                "x_mm,y_mm,z_mm,nx,ny,nz,name,E_Y,E_R,E_G,E_B\n"
                "0,0,500,0,0,-1,near,%.9g,%.9g,%.9g,%.9g\n"
                "100,-50,800.5,0,0.6,-0.8,far,%.9g,%.9g,%.9g,%.9g\n",
                e[0].y, e[0].r, e[0].g, e[0].b, e[1].y, e[1].r, e[1].g, e[1].b);
  std::ostringstream written;
  written << std::ifstream(folder_ / "truth.csv").rdbuf();
  EXPECT_EQ(written.str(), expected);
  EXPECT_GT(e[0].y, 0);
}

TEST_F(TruthTableTest, NamesTheLineThatIsWrong) {
  const std::string header = "x_mm,y_mm,z_mm,nx,ny,nz\n";
  const std::pair<std::string, int> cases[] = {{"x,y,z,nx,ny,nz\n0,0,1,0,0,1\n", 1},
                                               {header + "0,0,1,0,0,1\n0,0,x,0,0,1\n", 3},
                                               {header + "0,0,1,0,0\n", 2},
                                               {header + "0,0,nan,0,0,1\n", 2},
                                               {header + "0,0,1,0,0,0.5\n", 2},
                                               {header + "\n", 2},
                                               {header + std::string(10000, '1') + "\n", 2}};
  for (const auto& [table, line] : cases) {
    const Status status = write(table);
    ASSERT_FALSE(status) << table.substr(0, 100);
    EXPECT_EQ(status.error().where, place(line));
    EXPECT_FALSE(std::filesystem::exists(folder_ / "truth.csv"));
  }
  EXPECT_FALSE(write(""));
  EXPECT_FALSE(write_truth({}, false, folder_ / "absent.csv", folder_ / "truth.csv"));
}

TEST_F(TruthTableTest, RefusesAWorldThatCannotBe) {
  std::ofstream(folder_ / "points.csv") << "x_mm,y_mm,z_mm,nx,ny,nz\n0,0,500,0,0,-1\n";
  EXPECT_FALSE(write_truth({.window = 20}, false, folder_ / "points.csv", folder_ / "truth.csv"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "truth.csv"));
}

TEST_F(TruthTableTest, SaysThatItCannotWrite) {
  ASSERT_TRUE(write("x_mm,y_mm,z_mm,nx,ny,nz\n0,0,500,0,0,-1\n"));
  EXPECT_FALSE(write_truth({}, false, folder_ / "points.csv", folder_ / "absent" / "truth.csv"));
  EXPECT_FALSE(write_truth({}, false, folder_ / "points.csv", "/dev/full"));
}

}  // namespace
}  // namespace lumifield::virtual_bench
