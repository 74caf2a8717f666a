#include "luminaire/scene.h"

#include <cmath>
#include <fstream>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

namespace lumifield {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;
using testing::HasSubstr;

constexpr const char* documented = R"({ "format": "lumifield-scene", "version": 1, "mesh": "meshes/room.obj",
  "materials": { "wall": { "diffuse": [0.7,0.6,0.5] }, "floor": { "specular": [0.04,0.04,0.05], "roughness": 0.3 } },
  "camera": { "position_mm": [0, -2000, 1200], "target_mm": [0, 0, 800], "up": [0,0,1], "fov_y_deg": 45 },
  "luminaires": [ { "pose": [1,0,0,0, 0,0,-1,0, 0,1,0,1500, 0,0,0,1], "scale": 2 } ], "environment": "x.exr",
  "environment_scale": 0.5 })";

class SceneFile : public testing::Test {
 protected:
  SceneFile() { fs::create_directories(folder_ / "meshes"); }
  ~SceneFile() override { fs::remove_all(folder_.parent_path()); }
  std::string refusal_with(const char* pointer, const Json& value) const {
    Json json = Json::parse(documented);
    json[Json::json_pointer(pointer)] = value;
    const Result<Scene> scene = parse_scene(json.dump(), "scene.json", folder_);
    return scene ? "accepted" : scene.error().message();
  }
  fs::path folder_ =
      fs::path(testing::TempDir()) / std::string("scene_test_").append(std::to_string(getpid())) / "scenes";
};

TEST_F(SceneFile, ReadsTheDocumentedFile) {
  std::ofstream(folder_ / "scene.json") << documented;
  const Result<Scene> scene = read_scene(folder_ / "scene.json");
  ASSERT_TRUE(scene) << scene.error().message();
  EXPECT_EQ(scene->mesh, folder_ / "meshes/room.obj");
  EXPECT_EQ(scene->environment, folder_ / "x.exr");
  EXPECT_EQ(scene->environment_scale, 0.5);
  EXPECT_EQ(scene->materials.at("wall").diffuse, (std::array<double, 3>{0.7, 0.6, 0.5}));
  EXPECT_FALSE(scene->materials.at("wall").specular || scene->materials.at("wall").roughness);
  EXPECT_FALSE(scene->materials.at("floor").diffuse || scene->materials.at("floor").exponent);
  EXPECT_EQ(scene->materials.at("floor").specular, (std::array<double, 3>{0.04, 0.04, 0.05}));
  EXPECT_EQ(scene->materials.at("floor").roughness, 0.3);
  EXPECT_EQ(scene->camera.position_mm, Vec3(0, -2000, 1200));
  ASSERT_EQ(scene->luminaires.size(), 1u);
  EXPECT_EQ(scene->luminaires[0].scale, 2);
  EXPECT_EQ(scene->luminaires[0].pose(2, 3), 1500);
}

TEST_F(SceneFile, NotesWhatItHoldsWithoutEffect) {
  Json json = Json::parse(documented);
  json["enviroment"] = json["environment"];
  json.erase("environment");
  std::vector<std::string> notes;
  ASSERT_TRUE(parse_scene(json.dump(), "scene.json", folder_, &notes, ReaderNotes::ignored));
  EXPECT_THAT(notes, testing::ElementsAre("scene.json: environment_scale has no effect without \"environment\"",
                                          "scene.json: enviroment is not known and ignored"));
  notes.clear();
  ASSERT_TRUE(parse_scene(documented, "scene.json", folder_, &notes, ReaderNotes::ignored));
  EXPECT_THAT(notes, testing::IsEmpty());
}

TEST_F(SceneFile, NamesThePlaceOfWhatIsWrong) {
  EXPECT_THAT(refusal_with("/environment_scale", 1e300), HasSubstr("make it a number from 0, at most 1e+12"));
  EXPECT_THAT(refusal_with("/materials/wall/diffuse/1", 1.5),
              HasSubstr("scene.json: materials.wall.diffuse[1]: is out"));
  EXPECT_THAT(refusal_with("/materials/floor/specular/0", -0.1), HasSubstr("materials.floor.specular[0]: is out"));
  EXPECT_THAT(refusal_with("/materials/floor/roughness", 0.02), HasSubstr("floor.roughness: is out of range (0.02)"));
  EXPECT_THAT(refusal_with("/materials/wall/exponent", 0.5), HasSubstr("wall.exponent: is out of range (0.5)"));
  EXPECT_EQ(refusal_with("/materials/wall/exponent", 1e5), "accepted");
  EXPECT_THAT(refusal_with("/materials/floor/exponent", 20), HasSubstr("floor.exponent: stands beside a roughness"));
  EXPECT_THAT(refusal_with("/camera/fov_y_deg", 180), HasSubstr("camera.fov_y_deg: is out of range (180)"));
  EXPECT_THAT(refusal_with("/camera/target_mm", Json({0, -2000, 1200})), HasSubstr("is the camera's own position"));
  EXPECT_THAT(refusal_with("/camera/up", Json({0, 0, 0})), HasSubstr("camera.up: is zero or along the view"));
  EXPECT_THAT(refusal_with("/luminaires/0/pose/0", -1), HasSubstr("luminaires[0].pose: is no rigid placement"));
  EXPECT_THAT(refusal_with("/luminaires/0/scale", -1), HasSubstr("luminaires[0].scale: is out of range"));
  EXPECT_THAT(refusal_with("/format", "lumifield-plan"), HasSubstr("format: is not \"lumifield-scene\""));
  EXPECT_THAT(refusal_with("/version", 9), HasSubstr("version"));
}

TEST_F(SceneFile, KeepsPathsInsideTheFolder) {
  EXPECT_THAT(refusal_with("/mesh", ""), HasSubstr("mesh: is an empty path"));
  EXPECT_THAT(refusal_with("/mesh", "/etc/passwd"), HasSubstr("mesh: is an absolute path"));
  EXPECT_THAT(refusal_with("/mesh", "meshes/../../room.obj"), HasSubstr("mesh: leads out of the folder"));
  EXPECT_THAT(refusal_with("/mesh", std::string("a\0b", 3)), HasSubstr("mesh: is a path with a NUL"));
  EXPECT_THAT(refusal_with("/environment", "../x.exr"), HasSubstr("environment: leads out of the folder"));
  EXPECT_THAT(refusal_with("/environment_scale", -1), HasSubstr("environment_scale: is out of range"));
  fs::create_symlink("/etc", folder_ / "outside");
  EXPECT_THAT(refusal_with("/mesh", "outside/passwd"), HasSubstr("mesh: is a link that leads out of the folder"));
  fs::create_symlink("meshes", folder_ / "inside");
  EXPECT_EQ(refusal_with("/mesh", "inside/room.obj"), "accepted");
}

void expect_same(const Scene& a, const Scene& b) {
  EXPECT_EQ(a.name, b.name);
  EXPECT_EQ(a.mesh, b.mesh);
  EXPECT_EQ(a.environment, b.environment);
  EXPECT_EQ(a.environment_scale, b.environment_scale);
  ASSERT_EQ(a.materials.size(), b.materials.size());
  for (const auto& [name, material] : a.materials) {
    const MaterialOverride& other = b.materials.at(name);
    EXPECT_EQ(material.diffuse, other.diffuse);
    EXPECT_EQ(material.specular, other.specular);
    EXPECT_EQ(material.roughness, other.roughness);
    EXPECT_EQ(material.exponent, other.exponent);
  }
  EXPECT_EQ(a.camera.position_mm, b.camera.position_mm);
  EXPECT_EQ(a.camera.target_mm, b.camera.target_mm);
  EXPECT_EQ(a.camera.up, b.camera.up);
  EXPECT_EQ(a.camera.fov_y_deg, b.camera.fov_y_deg);
  ASSERT_EQ(a.luminaires.size(), b.luminaires.size());
  for (std::size_t k = 0; k < a.luminaires.size(); ++k) {
    EXPECT_EQ(a.luminaires[k].pose, b.luminaires[k].pose);
    EXPECT_EQ(a.luminaires[k].scale, b.luminaires[k].scale);
  }
}

TEST_F(SceneFile, IsReadBackAsItWasWritten) {
  Scene scene = *parse_scene(documented, "scene.json", folder_);
  scene.name = "two lamps";
  scene.materials["paint"].specular = {0.04, 0.05, 1.0 / 3};
  scene.materials["paint"].roughness = 0.3;
  scene.materials["old paint"].exponent = 12.5;
  ScenePlacement turned = scene.luminaires[0];
  const double c = std::cos(0.1), s = std::sin(0.1);
  turned.pose << c, -s, 0, 1.0 / 3, s, c, 0, -2.5e-7, 0, 0, 1, 1234.5678901234567, 0, 0, 0, 1;
  turned.scale = 0.1;
  scene.luminaires.push_back(turned);
  ASSERT_TRUE(write_scene(scene, folder_ / "saved.json"));
  const Result<Scene> read = read_scene(folder_ / "saved.json");
  ASSERT_TRUE(read) << read.error().message();
  expect_same(*read, scene);

  // In the folder above, where the mesh has a longer name.
  ASSERT_TRUE(write_scene(scene, folder_.parent_path() / "above.json"));
  const Result<Scene> above = read_scene(folder_.parent_path() / "above.json");
  ASSERT_TRUE(above) << above.error().message();
  expect_same(*above, scene);
}

TEST_F(SceneFile, IsNotWrittenWhereItCouldNotBeRead) {
  Scene scene = *parse_scene(documented, "scene.json", folder_);
  const auto refusal = [&](const fs::path& file) {
    const Status written = write_scene(scene, file);
    EXPECT_FALSE(fs::exists(file));
    return written ? "written" : written.error().message();
  };
  EXPECT_THAT(refusal(folder_ / "meshes/deep.json"), HasSubstr("environment"));
  scene.environment.reset();
  EXPECT_EQ(to_json(scene, folder_ / "meshes").has_value(), true) << "beside its mesh";
  fs::create_directory(folder_ / "elsewhere");
  EXPECT_THAT(
      refusal(folder_ / "elsewhere/scene.json"),
      testing::AllOf(HasSubstr("mesh"), HasSubstr("lies outside the folder"), HasSubstr("save the scene beside")));
  scene.luminaires[0].scale = -1;
  EXPECT_THAT(refusal(folder_ / "scale.json"), HasSubstr("luminaires[0].scale: is out of range"));
  scene.luminaires[0] = {};
  scene.luminaires[0].pose(0, 1) = 0.5;
  EXPECT_THAT(refusal(folder_ / "pose.json"), HasSubstr("luminaires[0].pose: is no rigid placement"));
}

}  // namespace
}  // namespace lumifield
