#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "luminaire/dataset.h"
#include "renderer/picture.h"
#include "renderer/renderer.h"
#include "tests/support/command_run.h"
#include "tests/support/dataset_folder.h"

namespace lumifield {
namespace {

using testing::HasSubstr;
using testing::Not;

class RenderCommand : public support::TemporaryFolder {
 protected:
  void SetUp() override {
    if (const auto gl = probe_opengl(); !gl) GTEST_SKIP() << gl.error().message();
    if (const auto cl = probe_opencl(); !cl) GTEST_SKIP() << cl.error().message();
    Manifest manifest;
    manifest.geometry = support::geometry(1, 1, 40, 40, {"Y"});
    auto writer = DatasetWriter::create(folder_ / "lamp.lumi", manifest);
    ASSERT_TRUE(writer->add({0, 0}, {40, 40, 1, std::vector<float>(1600, 1.0F), {}, {}}, {0, 0}));
    support::write_text(folder_ / "floor.mtl", "newmtl floor\nKd 0.5 0.5 0.5\nmap_Kd none.png\n");
    support::write_text(folder_ / "floor.obj",
                        "mtllib floor.mtl\nv -800 -500 900\nv 800 -500 900\nv 800 700 900\nv -800 700 900\n"
                        "usemtl floor\nf 1 2 3 4\n");
    Scene scene;
    scene.mesh = folder_ / "floor.obj";
    scene.camera.position_mm = {300, -1200, 100};
    scene.camera.target_mm = {0, 200, 900};
    scene.luminaires = {{}};
    scene.environment = folder_ / "sky.exr";
    ASSERT_TRUE(write_scene(scene, folder_ / "scene.json"));
    ASSERT_TRUE(write_exr({8, 4, std::vector<float>(96, 1.0F), std::vector<float>(32, 1.0F), {}}, folder_ / "sky.exr"));
  }
  void run(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), {"render", "--luminaire", folder_ / "lamp.lumi", "--scene",
                                         folder_ / "scene.json", "--out", folder_ / "out.exr", "--size", "16x12"});
    const support::CommandRun ran = support::run_command(std::move(arguments));
    out = ran.out;
    error = ran.error;
    EXPECT_EQ(ran.code, 0) << error;
  }

  std::string out, error;
};

TEST_F(RenderCommand, SaysWhatThePictureDoesNotShow) {
  const char* texture = "lumifield: note: material \"floor\": the texture none.png (map_Kd) is missing";
  const char* environment = "the environment behind the scene, what hides the environment";
  run({"--json"});
  EXPECT_THAT(error, HasSubstr(texture));
  EXPECT_THAT(nlohmann::json::parse(out)["left_out"].get<std::string>(), HasSubstr(environment));
  run({"--environment", "off"});
  EXPECT_THAT(error, HasSubstr(texture));
  EXPECT_THAT(out, Not(HasSubstr(environment)));
}

}  // namespace
}  // namespace lumifield
