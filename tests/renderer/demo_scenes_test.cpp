#include <filesystem>
#include <gtest/gtest.h>

#include "renderer/opengl/gbuffer.h"

namespace lumifield {
namespace {

const std::filesystem::path scenes = std::filesystem::path(LUMIFIELD_SOURCE_DIR) / "resources/scenes";

/// The scene at 4:3, seen without cracks: the share of covered pixels.
double covered_share(const Scene& scene, const Mesh& mesh) {
  auto context = EglContext::create();
  if (!context) return -1;
  const auto gbuffer = (*GBufferPass::create(**context, mesh))->draw(scene.camera, 320, 240);
  double covered = 0;
  for (std::size_t i = 3; i < gbuffer->position.size(); i += 4) covered += gbuffer->position[i];
  return covered / (320 * 240);
}

TEST(DemoScenes, ReadWithoutNotesAndCoverThePicture) {
  for (const char* name : {"corner", "pillars"}) {
    const auto scene = read_scene(scenes / name / "scene.json");
    ASSERT_TRUE(scene) << scene.error().message();
    EXPECT_EQ(scene->luminaires.size(), 1U);
    const auto mesh = read_mesh(scene->mesh, scene->materials);
    ASSERT_TRUE(mesh) << mesh.error().message();
    EXPECT_TRUE(mesh->notes.empty()) << mesh->notes.front();
    const double covered = covered_share(*scene, *mesh);
    if (covered < 0) GTEST_SKIP() << "no OpenGL";
    EXPECT_EQ(covered, 1) << name;
  }
}

TEST(DemoScenes, ThePillarsHaveAboutEightThousandTriangles) {
  const auto mesh = read_mesh(scenes / "pillars" / "room.obj");
  ASSERT_TRUE(mesh) << mesh.error().message();
  EXPECT_NEAR(static_cast<double>(mesh->triangles()), 8000, 400);
}

}  // namespace
}  // namespace lumifield
