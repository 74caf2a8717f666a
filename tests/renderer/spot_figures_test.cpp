#include "renderer/study/spot_figures.h"

#include <cmath>
#include <filesystem>
#include <gtest/gtest.h>
#include <set>
#include <unistd.h>

#include "renderer/renderer.h"
#include "renderer/scene/mesh.h"
#include "renderer/study/hall.h"
#include "renderer/study/spot_error_figures.h"
#include "tests/support/study_fixture.h"

namespace lumifield {
namespace {

TEST(ConstantDistanceFigures, HaveThePapersMaximaAndTheMethodsErrorBelowThem) {
  const auto rows = constant_distance_figures();
  ASSERT_EQ(rows.size(), 3u * 2 * 7 * 3);
  double axis = 0, across = 0;
  for (std::size_t k = 0; k < rows.size(); k += 3) {
    EXPECT_EQ(rows[k].quantity, "Er");
    if (rows[k].what.starts_with("support 0.04"))
      (rows[k].what.ends_with("axis") ? axis : across) =
          std::max(rows[k].what.ends_with("axis") ? axis : across, rows[k].ours);
    for (std::size_t far = 1; far <= 2; ++far) {
      EXPECT_GT(rows[k + far].ours, 0) << rows[k].what;
      EXPECT_LT(rows[k + far].ours, 1e-3) << rows[k].what << ": the method keeps each receiver's distance";
    }
  }
  // At 40° and 50°; the maximum, 8.0 and 11.3 %, is between.
  EXPECT_NEAR(axis, 0.079, 0.001);
  EXPECT_NEAR(across, 0.112, 0.001);
}

TEST(Hall, HasThePolygonsThatItSays) {
  const auto folder = std::filesystem::temp_directory_path() / ("hall_test_" + std::to_string(::getpid()));
  std::filesystem::create_directories(folder);
  for (const int sides : {10, 144}) {
    const auto scene = write_hall(folder, sides);
    ASSERT_TRUE(scene) << scene.error().message();
    EXPECT_EQ(read_mesh(scene->mesh, {}).value().triangles(), static_cast<std::size_t>(56 * sides - 44));
  }
  std::filesystem::remove_all(folder);
  EXPECT_FALSE(write_hall(folder / "none", 10));
}

TEST(SpotSpeedFigures, HaveThePapersNumbersBesideThemAndStop) {
  if (const auto gl = probe_opengl(); !gl) GTEST_SKIP() << gl.error().message();
  const auto rows = spot_speed_figures(true, [](double, const std::string&) { return true; });
  ASSERT_TRUE(rows) << rows.error().message();
  std::set<double> paper;
  for (const FigureRow& row : *rows) {
    EXPECT_GT(row.ours, 0) << row.what << ' ' << row.quantity;
    if (row.quantity == "frames/s") paper.insert(row.paper);
    if (row.quantity == "relative RMSE") {
      EXPECT_LT(row.ours, row.what.starts_with("16") ? 0.015 : 0.03) << row.what;
    }
  }
  EXPECT_EQ(paper, (std::set<double>{2.7, 0.55}));
  const auto stopped = spot_speed_figures(true, [](double, const std::string&) { return false; });
  ASSERT_FALSE(stopped);
  EXPECT_EQ(stopped.error().kind, ErrorKind::stopped);
}

TEST(SpotSpeedFigures, SayWhereTheirHallsCannotBe) {
  const WithoutTemporaryFolder none;
  const auto rows = spot_speed_figures(true, [](double, const std::string&) { return true; });
  ASSERT_FALSE(rows);
  EXPECT_NE(rows.error().message().find("TMPDIR"), std::string::npos) << rows.error().message();
}

}  // namespace
}  // namespace lumifield
