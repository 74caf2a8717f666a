#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "app/session/provenance.h"
#include "luminaire/dataset.h"
#include "renderer/picture.h"
#include "tests/support/command_run.h"
#include "tests/support/dataset_folder.h"

namespace lumifield {
namespace {

using testing::HasSubstr;

class CheckCommand : public support::TemporaryFolder {
 protected:
  /// Of a scene that names this environment; what is found goes to `out`.
  int check_with(const std::string& environment) {
    const std::string scene = folder_ / "scene.json";
    support::write_text(scene, R"({"format": "lumifield-scene", "version": 1, "mesh": "room.obj", "environment": ")" +
                                   environment +
                                   R"(", "camera": {"position_mm": [0, 0, 1], "target_mm": [1, 0, 1], "up": [0, 0, 1],
                                       "fov_y_deg": 45}, "luminaires": []})");
    return check(scene);
  }
  int check(const std::string& path) {
    const support::CommandRun run = support::run_command({"check", path});
    out = run.out;
    return run.code;
  }
  std::string image(const std::string& name, int width, int height) const {
    const auto pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
    EXPECT_TRUE(write_exr({width, height, std::vector<float>(3 * pixels, 1), std::vector<float>(pixels, 1), {}},
                          folder_ / name));
    return name;
  }

  std::string out;
};

TEST_F(CheckCommand, ReadsTheEnvironmentOfAScene) {
  EXPECT_EQ(check_with("none.exr"), 1);
  EXPECT_THAT(out, HasSubstr("NOT sound"));
  EXPECT_THAT(out, HasSubstr("none.exr"));
  EXPECT_EQ(check_with(image("sky.exr", 3, 2)), 1);
  EXPECT_THAT(out, HasSubstr("sky.exr: is an image of 3 x 2 pixels, no latitude-longitude map"));
  EXPECT_EQ(check_with(image("sky.exr", 4, 2)), 0) << out;
  EXPECT_THAT(out, HasSubstr("scene.json: sound"));
}

TEST_F(CheckCommand, TellsHowGoodTheCellsOfADatasetAre) {
  Manifest manifest;
  manifest.geometry = support::geometry(3, 1, 8, 8, {"Y"});
  manifest.provenance_json = R"({"scans": [{"reference": [{"drift": 0.001}, {"drift": -0.0125}],
                                            "plan": {"reference_cell": {"limit": 0.01}}}]})";
  const std::string folder = folder_ / "lamp.lumi";
  auto writer = DatasetWriter::create(folder, manifest);
  const std::vector<std::vector<std::string>> warnings{
      {"0.5 % of the pixels are saturated", "no dark set"}, {}, {"1.25e-3 % of the pixels are saturated"}};
  for (int k = 0; k < 3; ++k) {
    CellImage image{8, 8, 1, std::vector<float>(64, 1), {}, {}};
    image.quality.warnings = warnings[static_cast<std::size_t>(k)];
    ASSERT_TRUE(writer->add({0, k}, image, {0, 0}));
  }
  ASSERT_TRUE(writer->close());
  EXPECT_EQ(check(folder), 0) << out;
  EXPECT_THAT(out, HasSubstr("sound, 3 of 3 cells, 2 with warnings, largest drift -1.25 % (the plan's limit: 1 %)\n"));
  EXPECT_THAT(out, HasSubstr("note: warning of 2 cells: … % of the pixels are saturated\n"));
  EXPECT_THAT(out, HasSubstr("note: warning of 1 cells: no dark set\n"));
  EXPECT_EQ(check(folder_), 1);
  EXPECT_THAT(out, HasSubstr("there is no dataset there, but a folder that holds " + folder));
}

TEST(LargestDrift, IsOfReadingsOnRecordAlone) {
  EXPECT_FALSE(largest_drift("{}"));
  EXPECT_FALSE(largest_drift(R"({"scans": [{"reference": []}]})"));
  EXPECT_FALSE(largest_drift(R"({"scans": ["by hand"]})"));
}

}  // namespace
}  // namespace lumifield
