#include "app/cli/points_csv.h"

#include <fstream>
#include <gtest/gtest.h>
#include <unistd.h>

#include "tests/support/csv_table.h"

namespace lumifield {
namespace {

class PointsCsv : public testing::Test {
 protected:
  std::filesystem::path file_ =
      std::filesystem::path(testing::TempDir()) / ("points_" + std::to_string(getpid()) + ".csv");
  Result<std::vector<Receiver>> read(const std::string& text) {
    std::ofstream(file_) << text;
    notes_.clear();
    return read_points_csv(file_, notes_);
  }
  std::vector<std::string> notes_;
  void refused(const std::string& text, const std::string& place) {
    const auto points = read(text);
    ASSERT_FALSE(points) << text;
    EXPECT_NE(points.error().message().find(place), std::string::npos) << points.error().message();
  }
};

TEST_F(PointsCsv, ColumnsMayComeInAnyOrder) {
  const auto points = read("nz,x_mm,y_mm,z_mm,nx,ny\r\n-1, 1,2.5,3e2,0,0\r\n\n");
  ASSERT_TRUE(points) << points.error().message();
  ASSERT_EQ(points->size(), 1u);
  EXPECT_EQ(points->front().p_mm, Vec3(1, 2.5, 300));
  EXPECT_EQ(points->front().n, Vec3(0, 0, -1));
}

TEST_F(PointsCsv, SpreadsheetsWriteThem) {
  const auto points = read("\xef\xbb\xbfname,x_mm,y_mm,z_mm,nx,ny,nz,\r\ndesk,1,2,300,0,0,-1,\r\n");
  ASSERT_TRUE(points) << points.error().message();
  ASSERT_EQ(points->size(), 1u);
  EXPECT_EQ(points->front().p_mm, Vec3(1, 2, 300));
  ASSERT_EQ(notes_.size(), 2u) << "what is not read is told";
  EXPECT_NE(notes_[0].find("line 1: column 'name' is passed over"), std::string::npos) << notes_[0];
  ASSERT_TRUE(read("x_mm,y_mm,z_mm,nx,ny,nz\n1,2,3,0,0,1\n"));
  EXPECT_TRUE(notes_.empty());
}

TEST_F(PointsCsv, RefusesWithLineAndColumn) {
  refused("", "is empty");
  refused("x_mm,y_mm,z_mm,nx,ny\n", "line 1: column 'nz' is missing");
  refused("x_mm,y_mm,z_mm,nx,ny,nx\n", "'nx'");
  refused("x_mm,y_mm,z_mm,nx,ny,nz\n", "no points");
  refused("x_mm,y_mm,z_mm,nx,ny,nz\n1,2,3,0,0,1\n1,2,3,0,0\n", "line 3: has 5 columns, the first line 6");
  refused("x_mm,y_mm,z_mm,nx,ny,nz\n1,nan,3,0,0,1\n", "line 2, column y_mm");
  refused("x_mm,y_mm,z_mm,nx,ny,nz\n1,2,3,0,0,2\n", "length 2");
  refused("x_mm,y_mm,z_mm,nx,ny,nz\n1,2,3,0,0,0\n", "length 0");
  EXPECT_FALSE(read_points_csv("/nowhere/points.csv", notes_));
}

TEST_F(PointsCsv, WritesWhatItReads) {
  const std::vector<Receiver> points{{{0.1, -2, 1e5}, {0, 0.6, -0.8}}};
  ASSERT_TRUE(write_points_csv(file_, points, {"R", "G"}, {1.5, 2.25}));
  auto table = test::read_csv_table(file_);
  EXPECT_EQ(table["x_mm"], std::vector<double>{0.1});
  EXPECT_EQ(table.count("stated_error_R"), 0u);
  EXPECT_EQ(table["E_R"], std::vector<double>{1.5});
  EXPECT_EQ(table["E_G"], std::vector<double>{2.25});
  std::ifstream written(file_);
  std::string header, line;
  std::getline(written, header);
  std::getline(written, line);
  EXPECT_EQ(line, "0.1,-2,1e+05,0,0.6,-0.8,1.5,2.25") << "points as they were given";
  ASSERT_TRUE(write_points_csv(file_, points, {"R", "G"}, {1.5, 2.25}, {0.125, 0.25}));
  table = test::read_csv_table(file_);
  EXPECT_EQ(table["E_G"], std::vector<double>{2.25});
  EXPECT_EQ(table["stated_error_R"], std::vector<double>{0.125});
  EXPECT_EQ(table["stated_error_G"], std::vector<double>{0.25});
  EXPECT_FALSE(write_points_csv("/nowhere/e.csv", points, {"R", "G"}, {1.5, 2.25}));
  EXPECT_FALSE(write_points_csv("/dev/full/e.csv", points, {"R", "G"}, {1.5, 2.25}));
}

}  // namespace
}  // namespace lumifield
