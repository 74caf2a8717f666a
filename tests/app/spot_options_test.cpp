// What the command line says of shift-invariant: which of its two pictures, by what device, with what shadows.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "luminaire/dataset.h"
#include "renderer/renderer.h"
#include "tests/support/command_run.h"
#include "tests/support/dataset_folder.h"

namespace lumifield {
namespace {

using testing::HasSubstr;

constexpr const char* scene = LUMIFIELD_SOURCE_DIR "/resources/scenes/corner/scene.json";
constexpr int wrong_use = 2;

class SpotOptions : public support::TemporaryFolder {
 protected:
  int run(std::vector<std::string> arguments) {
    const support::CommandRun ran = support::run_command(std::move(arguments));
    out = ran.out;
    error = ran.error;
    return ran.code;
  }
  nlohmann::json summary(const std::vector<std::string>& arguments) {
    EXPECT_EQ(run(arguments), 0) << error;
    return nlohmann::json::parse(out);
  }
  /// A lamp of 2 × 1 cells, one column of seven bright, so that it matters how an image is averaged.
  std::string dataset() const {
    const std::filesystem::path folder = folder_ / "lamp.lumi";
    if (std::filesystem::exists(folder)) return folder;
    Manifest manifest;
    manifest.geometry = support::geometry(2, 1, 40, 40, {"Y"});
    auto writer = DatasetWriter::create(folder, manifest);
    std::vector<float> stripes;
    for (int k = 0; k < 1600; ++k) stripes.push_back(k % 40 % 7 == 0 ? 7.0F : 0.1F);
    for (int k = 0; k < 2; ++k) EXPECT_TRUE(writer->add({0, k}, {40, 40, 1, stripes, {}, {}}, {0, 0}));
    return folder;
  }
  std::vector<std::string> probe(std::vector<std::string> more) const {
    support::write_text(folder_ / "points.csv", "x_mm,y_mm,z_mm,nx,ny,nz\n1,2,400,0,0,-1\n");
    more.insert(more.begin(), {"probe", "--luminaire", dataset(), "--points", folder_ / "points.csv", "--out",
                               folder_ / "e.csv", "--json"});
    return more;
  }
  std::vector<std::string> render(std::vector<std::string> more) const {
    more.insert(more.begin(), {"render", "--luminaire", dataset(), "--scene", scene, "--size", "40x30", "--out",
                               folder_ / "picture.exr", "--json"});
    return more;
  }
  std::string out, error;
};

TEST_F(SpotOptions, OfOtherMethodsAreWrongUse) {
  EXPECT_EQ(run(probe({"--spots", "textured"})), wrong_use);
  EXPECT_THAT(error, HasSubstr("shift-invariant alone"));
  EXPECT_EQ(run(probe({"--method", "shift-invariant", "--spots", "blurred"})), wrong_use);
  EXPECT_THAT(error, HasSubstr("weighted"));
}

TEST_F(SpotOptions, ShadowsThatItDoesNotTakeAreRefused) {
  for (const char* shadows : {"tile", "rays", "published"}) {
    EXPECT_EQ(run(render({"--method", "shift-invariant", "--shadows", shadows})), wrong_use) << shadows;
    EXPECT_THAT(error, HasSubstr("has a depth map of each cell; give none"));
  }
  EXPECT_FALSE(std::filesystem::exists(folder_ / "picture.exr"));
}

TEST_F(SpotOptions, TheProbeTellsTheLookUpAndItsDevice) {
  const auto on_host = summary(probe({"--method", "shift-invariant", "--spots", "textured"}));
  EXPECT_EQ(on_host["spots"], "textured");
  EXPECT_EQ(on_host["device"], "host");
  const std::string textured = support::read_text(folder_ / "e.csv");
  EXPECT_EQ(summary(probe({"--method", "shift-invariant"}))["spots"], "weighted");
  EXPECT_NE(support::read_text(folder_ / "e.csv"), textured) << "two pictures";
  EXPECT_FALSE(summary(probe({})).contains("spots"));
  if (!probe_opengl()) GTEST_SKIP() << probe_opengl().error().message();
  EXPECT_EQ(summary(probe({"--method", "shift-invariant", "--device", "opencl"}))["device"], "opengl");
}

TEST_F(SpotOptions, ThePictureTellsTheLookUpAndItsShadows) {
  if (!probe_opengl()) GTEST_SKIP() << probe_opengl().error().message();
  const auto shadowed = summary(render({"--method", "shift-invariant", "--spots", "textured"}));
  EXPECT_EQ(shadowed["spots"], "textured");
  EXPECT_EQ(shadowed["shadows"], "cell");
  EXPECT_THAT(shadowed["left_out"].get<std::string>(), HasSubstr("(shift-invariant, textured)"));
  EXPECT_THAT(support::read_text(folder_ / "picture.exr"), HasSubstr("(shift-invariant, textured)"));
  const auto lit = summary(render({"--method", "shift-invariant", "--shadows", "none"}));
  EXPECT_EQ(lit["spots"], "weighted");
  EXPECT_EQ(lit["shadows"], "none");
}

}  // namespace
}  // namespace lumifield
