#include <algorithm>
#include <filesystem>
#include <gtest/gtest.h>

#include "renderer/opengl/gbuffer.h"

namespace lumifield {
namespace {

const std::filesystem::path scenes = std::filesystem::path(LUMIFIELD_SOURCE_DIR) / "resources/scenes";

struct DemoScene {
  const char* name;
  std::size_t luminaires;
  double least_covered;  ///< share of the picture; the road has a night sky
};
constexpr DemoScene demo_scenes[] = {{"corner", 1, 1}, {"pillars", 1, 1}, {"road", 2, 0.75}};

class DemoScenes : public testing::TestWithParam<DemoScene> {
 protected:
  void SetUp() override {
    scene_ = read_scene(scenes / GetParam().name / "scene.json").value();
    mesh_ = read_mesh(scene_.mesh, scene_.materials).value();
  }
  Scene scene_;
  Mesh mesh_;
};

TEST_P(DemoScenes, ReadWithoutNotesAndAreSeenWithoutCracks) {
  EXPECT_EQ(scene_.luminaires.size(), GetParam().luminaires);
  EXPECT_TRUE(mesh_.notes.empty()) << mesh_.notes.front();
  auto context = EglContext::create();
  if (!context) GTEST_SKIP() << context.error().message();
  const auto gbuffer = (*GBufferPass::create(**context, mesh_))->draw(scene_.camera, 320, 240);
  double covered = 0;
  for (std::size_t i = 3; i < gbuffer->position.size(); i += 4) covered += gbuffer->position[i];
  EXPECT_GE(covered / (320 * 240), GetParam().least_covered);
  // Every material is in the picture.
  for (std::size_t m = 0; m < mesh_.materials.size(); ++m) {
    std::size_t seen = 0;
    for (std::size_t i = 3; i < gbuffer->normal.size(); i += 4)
      seen += gbuffer->position[i] != 0 && gbuffer->normal[i] == static_cast<float>(m);
    EXPECT_GT(seen, 20U) << mesh_.materials[m].name;
  }
}

INSTANTIATE_TEST_SUITE_P(All, DemoScenes, testing::ValuesIn(demo_scenes),
                         [](const auto& each) { return each.param.name; });

Mesh mesh_of(const char* name) { return read_mesh(scenes / name / "room.obj").value(); }

const Material& material(const Mesh& mesh, const std::string& name) {
  const auto found = std::ranges::find(mesh.materials, name, &Material::name);
  EXPECT_NE(found, mesh.materials.end()) << name;
  return *found;
}

TEST(DemoMeshes, HaveAboutTheTrianglesThatTheyAreMadeWith) {
  EXPECT_EQ(mesh_of("corner").triangles(), 4446U) << "benchmarks stand on it";
  EXPECT_NEAR(static_cast<double>(mesh_of("pillars").triangles()), 8000, 400);
  EXPECT_NEAR(static_cast<double>(mesh_of("road").triangles()), 7500, 2500);
}

TEST(DemoMeshes, ShineAndHaveATexture) {
  const Mesh corner = mesh_of("corner"), pillars = mesh_of("pillars"), road = mesh_of("road");
  for (const Material& m : corner.materials) EXPECT_EQ(m.lobe, LOBE_NONE) << m.name;
  EXPECT_FLOAT_EQ(material(pillars, "floor").shape, 0.09F);
  EXPECT_EQ(material(pillars, "floor").specular[1], 0.04F);
  EXPECT_EQ(material(pillars, "brass").diffuse, (std::array{0.0F, 0.0F, 0.0F})) << "a metal";
  EXPECT_FLOAT_EQ(material(road, "road").shape, 0.35F * 0.35F);
  ASSERT_TRUE(material(road, "sign").texture);
  EXPECT_EQ(road.textures.size(), 1U);
  EXPECT_LT(std::filesystem::file_size(scenes / "road" / "sign.png"), 20'000U);
}

}  // namespace
}  // namespace lumifield
