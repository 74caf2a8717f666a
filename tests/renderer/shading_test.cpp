#include "renderer/shading.h"

#include <Eigen/Geometry>
#include <gtest/gtest.h>
#include <numbers>

namespace lumifield {
namespace {

/// Three pixels: background, a surface of material 0, one of material 1.
GBuffer three_pixels() {
  return {3,
          1,
          {0, 0, 0, 0, 100, 200, 300, 1, -50, 0, 10, 1},
          {0, 0, 0, 0, 0, 0, 1, 0, 0, 1, 0, 1},
          {0, 0, 0, 0, 0, 0, 1, 0, 0, 1, 0, 0},
          {}};
}

std::vector<ScenePlacement> two_placements() {
  std::vector<ScenePlacement> placements(2);
  placements[1].scale = 3;
  placements[1].pose.topLeftCorner<3, 3>() = Eigen::AngleAxisd(0.8, Vec3(1, 2, -0.5).normalized()).toRotationMatrix();
  placements[1].pose.topRightCorner<3, 1>() = Vec3(500, -20, 70);
  return placements;
}

Picture empty_picture() { return {3, 1, std::vector<float>(9), std::vector<float>(3), {}}; }

TEST(Shading, LobesLookFromTheirReceiversToTheEye) {
  const GBuffer g = three_pixels();
  std::vector<Material> materials = {{.name = "dull"}, {.name = "metal"}};
  const Vec3 eye(30, 900, 400);
  const auto placements = two_placements();
  EXPECT_TRUE(lobes_of(g, materials, placements, eye).empty());
  materials[1].lobe = LOBE_GGX;
  materials[1].shape = 0.09F;
  materials[1].specular = {0.9F, 0.6F, 0.1F};
  const auto lobes = lobes_of(g, materials, placements, eye);
  const Receivers receivers = receivers_of(g, placements);
  ASSERT_EQ(lobes.size(), receivers.p.size() / 4);
  for (std::size_t k = 0; k < lobes.size(); ++k) {
    const GlossLobe& lobe = lobes[k];
    EXPECT_EQ(lobe.kind, k % 3 == 2 ? LOBE_GGX : LOBE_NONE);
    if (k % 3 != 2) continue;
    EXPECT_EQ(lobe.shape, 0.09F);
    EXPECT_EQ(lobe.g, 0.6F);
    const Vec3 p(receivers.p[4 * k], receivers.p[4 * k + 1], receivers.p[4 * k + 2]);
    const Vec3 towards = transform_point(placements[k / 3].pose.inverse(), eye) - p;
    EXPECT_LT((Vec3(lobe.eye_x, lobe.eye_y, lobe.eye_z) - towards.normalized()).norm(), 1e-6);
  }
}

TEST(Shading, TheGBuffersReflectanceStandsBeforeTheMaterials) {
  GBuffer g = three_pixels();
  const std::vector<Material> materials = {{.name = "a", .diffuse = {0.5F, 0.25F, 0}},
                                           {.name = "b", .diffuse = {1, 0.75F, 1}}};
  EXPECT_EQ(diffuse_at(g, materials, 1)[1], 0.25F);
  EXPECT_EQ(diffuse_at(g, materials, 2)[1], 0.75F);
  g.reflectance = {0, 0, 0, 0, 0.1F, 0.2F, 0.3F, 0, 0.4F, 0.6F, 0.8F, 0};
  EXPECT_EQ(diffuse_at(g, materials, 1)[1], 0.2F);
  EXPECT_EQ(diffuse_at(g, materials, 2)[1], 0.6F);
}

TEST(Shading, AddsGlossOfOneOrThreeChannelsToTheDiffuse) {
  GBuffer g = three_pixels();
  const std::vector<Material> materials = {{.name = "a", .diffuse = {0.5F, 0.25F, 0}},
                                           {.name = "b", .diffuse = {1, 1, 1}}};
  const std::vector<double> e = {9, 1, 2, 9, 10, 20}, grey = {9, 0.5, 0.25, 9, 2, 4};
  std::vector<double> coloured;
  for (const double v : grey) coloured.insert(coloured.end(), {v, 2 * v, 0});
  constexpr double pi = std::numbers::pi;
  Picture picture = empty_picture();
  const auto expect = [&](std::size_t k, double value) { EXPECT_NEAR(picture.rgb[k], value, 1e-6 * value) << k; };

  shade(g, materials, two_placements(), {e, 1, grey, 1}, {}, picture);
  EXPECT_EQ(picture.coverage, (std::vector<float>{0, 1, 1}));
  for (std::size_t k = 0; k < 3; ++k) EXPECT_EQ(picture.rgb[k], 0);
  expect(3, 0.5 * 31 / pi + 6.5);
  expect(5, 6.5);
  expect(8, 62 / pi + 12.25);

  shade(g, materials, two_placements(), {e, 1, coloured, 3}, {}, picture);
  expect(4, 0.25 * 31 / pi + 13);
  EXPECT_EQ(picture.rgb[5], 0);
  expect(7, 62 / pi + 24.5);

  // Of a textured G-buffer its own reflectance counts.
  g.reflectance = {0, 0, 0, 0, 0.125F, 0, 1, 0, 0, 0, 0, 0};
  shade(g, materials, two_placements(), {e, 1}, {}, picture);
  expect(3, 0.125 * 31 / pi);
  expect(5, 31 / pi);
  EXPECT_EQ(picture.rgb[8], 0);
}

TEST(Shading, AddsAnEnvironment) {
  // A diffuse, a Phong and a background pixel under the same light from everywhere: E = π L, and Phong along the normal
  // gives its k_s.
  GBuffer g{3, 1, {}, {}, {}, {}};
  g.position = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 0};
  g.normal = {0, 0, 1, 0, 0, 0, 1, 1, 0, 0, 0, 0};
  const std::vector<Material> materials{
      {.name = "dull", .diffuse = {0.5F, 0.25F, 0}},
      {.name = "bright", .diffuse = {0.5F, 0.25F, 0}, .specular = {0.2F, 0.1F, 0.4F}, .lobe = LOBE_PHONG, .shape = 20}};
  const EnvironmentLight even(LatLong(64, 32, std::vector<float>(3 * 64 * 32, 3.0F)), 2);
  std::vector<float> light(9, 7.0F);
  shade_by_environment(g, materials, even, {0, 0, 500}, 0, 2, light);
  EXPECT_EQ(light[8], 7) << "another piece";
  shade_by_environment(g, materials, even, {0, 0, 500}, 2, 3, light);
  const double wanted[] = {3, 1.5, 0, 3 + 1.2, 1.5 + 0.6, 2.4, 0, 0, 0};
  for (std::size_t k = 0; k < 9; ++k) EXPECT_NEAR(light[k], wanted[k], 2e-3 * wanted[k]) << k;
  Picture picture{3, 1, std::vector<float>(9), std::vector<float>(3), {}};
  const std::vector<double> e{1, 2, 0};
  shade(g, materials, {ScenePlacement{}}, {e, 1}, light, picture);
  EXPECT_NEAR(picture.rgb[3], light[3] + 0.5 * 2 * std::numbers::inv_pi, 1e-6);
  EXPECT_EQ(picture.rgb[8], 0);
}

TEST(Shading, SaysWhatIsLeftOut) {
  EXPECT_EQ(left_out(Visibility::none), "shadows, and light from surface to surface");
  EXPECT_EQ(left_out(Visibility::tile), "light from surface to surface");
  EXPECT_EQ(left_out(Visibility::none, true), "shadows, what hides the environment, and light from surface to surface");
  EXPECT_EQ(left_out(Visibility::rays, true), "what hides the environment, and light from surface to surface");
  MethodSettings spots{.method = Method::shift_invariant};
  EXPECT_EQ(left_out(Visibility::tile, false, spots),
            "light from surface to surface; where within a cell its light comes from (shift-invariant, weighted)");
  spots.spots.look_up = SpotLookUp::textured;
  EXPECT_EQ(left_out(Visibility::none, false, spots),
            "shadows, and light from surface to surface; where within a cell its light comes from (shift-invariant, "
            "textured)");
}

}  // namespace
}  // namespace lumifield
