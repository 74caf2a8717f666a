// `lumifield render` and `lumifield probe`.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "app/cli/piecewise.h"
#include "luminaire/dataset.h"
#include "tests/support/command_run.h"
#include "tests/support/csv_table.h"
#include "tests/support/dataset_folder.h"

namespace lumifield {
namespace {

using support::CommandRun;
using support::Operator;
using support::run_command;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

constexpr const char* corner = LUMIFIELD_SOURCE_DIR "/resources/scenes/corner/scene.json";

class LightCommands : public support::TemporaryFolder {
 protected:
  /// A lamp of 2 × 1 cells, `measured` of them.
  std::string lamp(int measured = 2) const {
    Manifest manifest;
    manifest.geometry = support::geometry(2, 1, 40, 40, {"Y"});
    const std::filesystem::path folder = folder_ / "lamp.lumi";
    auto writer = DatasetWriter::create(folder, manifest);
    for (int k = 0; k < measured; ++k)
      EXPECT_TRUE(writer->add({0, k}, {40, 40, 1, std::vector<float>(1600, 1), {}, {}}, {0, 0}));
    return folder;
  }
  std::string points(const std::string& lines, int times = 1) const {
    std::string text = "x_mm,y_mm,z_mm,nx,ny,nz\n";
    for (int k = 0; k < times; ++k) text += lines;
    support::write_text(folder_ / "points.csv", text);
    return folder_ / "points.csv";
  }
  CommandRun probe(const std::string& points, std::vector<std::string> more = {}) const {
    more.insert(more.begin(), {"probe", "--luminaire", folder_ / "lamp.lumi", "--points", points, "--out", e_csv()});
    return run_command(more);
  }
  CommandRun render(const std::string& scene, std::vector<std::string> more = {}) const {
    more.insert(more.begin(), {"render", "--luminaire", folder_ / "lamp.lumi", "--scene", scene, "--out", picture()});
    return run_command(more);
  }
  std::string e_csv() const { return folder_ / "e.csv"; }
  std::string picture() const { return folder_ / "picture.png"; }
};

TEST_F(LightCommands, AnOutputThatCannotBeWrittenIsToldFirst) {
  // So early that nobody has asked for the luminaire yet.
  const std::string nowhere = folder_ / "nowhere/out";
  CommandRun run = run_command({"probe", "--luminaire", "x", "--points", "y", "--out", nowhere + ".csv"});
  EXPECT_EQ(run.code, 1);
  EXPECT_THAT(run.error, HasSubstr(nowhere + ".csv: could not be made: No such file or directory"));
  run = run_command({"render", "--luminaire", "x", "--scene", "y", "--out", nowhere + ".png"});
  EXPECT_EQ(run.code, 1);
  EXPECT_THAT(run.error, HasSubstr(nowhere + ".png: could not be made: No such file or directory"));
}

TEST_F(LightCommands, WhatASceneHoldsWithoutEffectIsNoted) {
  lamp();
  std::string text = support::read_text(corner);
  text.insert(text.rfind('}'), R"(, "enviroment": "lab.exr", "environment_scale": 2)");
  const std::filesystem::path room = std::filesystem::path(corner).parent_path();
  std::filesystem::copy(room, folder_ / "room", std::filesystem::copy_options::recursive);
  support::write_text(folder_ / "room/scene.json", text);
  const CommandRun run = render(folder_ / "room/scene.json", {"--size", "32x24"});
  EXPECT_EQ(run.code, 0) << run.error;
  EXPECT_THAT(run.error, HasSubstr("lumifield: note: " + (folder_ / "room/scene.json").string() +
                                   ": enviroment is not known and ignored\n"));
  EXPECT_THAT(run.error, HasSubstr("environment_scale has no effect without \"environment\"\n"));
  EXPECT_THAT(run.error, Not(HasSubstr("is absent"))) << "defaults are for `check` to tell";
  EXPECT_THAT(run.out, HasSubstr("closed-form, shadows tile, 2 of 2 cells, "));
}

TEST_F(LightCommands, StopsWhereTheOperatorSays) {
  lamp();
  {
    const Operator one;
    const CommandRun run = render(corner, {"--size", "1024x768", "--method", "reference", "--shadows", "none"});
    EXPECT_EQ(run.code, 3) << run.error;
    EXPECT_THAT(run.error, HasSubstr("lumifield: light: stopped by the operator\n"));
  }
  EXPECT_FALSE(std::filesystem::exists(picture()));
  for (const char* device : {"host", "opencl"}) {
    const Operator one;
    const CommandRun run =
        probe(points("0,0,500,0,0,-1\n", 20'000), {"--method", "uniform-box", "--samples", "1e6", "--device", device});
    EXPECT_EQ(run.code, 3) << run.error;
    EXPECT_THAT(run.error, HasSubstr("stopped by the operator"));
    EXPECT_FALSE(std::filesystem::exists(e_csv()));
  }
}

TEST_F(LightCommands, AQuickOneHasNoProgress) {
  lamp();
  EXPECT_THAT(probe(points("0,0,500,0,0,-1\n")).error, IsEmpty());
  EXPECT_EQ(share_text(0.25, 10), " 25 %, 0:10 elapsed, 0:30 left");
  EXPECT_EQ(share_text(0, 10), "  0 %, 0:10 elapsed");
}

TEST_F(LightCommands, ProbeNotesWhatItsValuesLack) {
  lamp(1);
  const std::string two = points("0,0,500,0,0,-1\n0,0,-10,0,0,1\n");
  CommandRun run = probe(two);
  EXPECT_EQ(run.code, 0) << run.error;
  EXPECT_THAT(run.error, HasSubstr("1 of 2 cells are unmeasured; their light is missing\n"));
  EXPECT_THAT(run.error, HasSubstr("1 of 2 points are behind the luminaire or in its plane"));
  const auto table = test::read_csv_table(e_csv());
  EXPECT_GT(table.at("E_Y")[0], 0);
  EXPECT_EQ(table.at("E_Y")[1], 0);
  run = probe(two, {"--stated-error", "--method", "filtered-brdf", "--samples", "10"});
  EXPECT_THAT(run.error, HasSubstr("at 1 of 2 points the stated error is above a quarter of the value"));
  run = probe(two, {"--stated-error"});
  EXPECT_THAT(run.error, Not(HasSubstr("quarter")));
}

TEST_F(LightCommands, AFolderThatHoldsADatasetIsNoDataset) {
  const std::string inside = lamp();
  const CommandRun run =
      run_command({"probe", "--luminaire", folder_, "--points", points("0,0,500,0,0,-1\n"), "--out", e_csv()});
  EXPECT_EQ(run.code, 1);
  EXPECT_THAT(run.error, HasSubstr("is no dataset, but a folder that holds " + inside + "; name what it holds\n"));
}

}  // namespace
}  // namespace lumifield
