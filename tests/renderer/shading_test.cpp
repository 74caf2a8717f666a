#include "renderer/shading.h"

#include <Eigen/Geometry>
#include <gtest/gtest.h>
#include <numbers>

#include "renderer/methods/gloss.h"

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

TEST(Shading, SeesAnEnvironmentsSourceWhereItStands) {
  // One source off every axis; a Phong pixel, its normal tilted, seen obliquely and about mirrored to it; a diffuse
  // one.
  const Vec3 source = Vec3(0.6, -0.3, 0.7).normalized(), n = Vec3(0.2, 0.1, 1).normalized(), p(100, 200, 300);
  std::vector<float> rgb(3 * 128 * 64, 0.0F);
  const LatLong empty(128, 64, rgb);
  const auto [column, row] = empty.pixel_at(source);
  for (int k = 0; k < 9; ++k)
    rgb[static_cast<std::size_t>(3 * ((row + k / 3 - 1) * 128 + column + k % 3 - 1) + 1)] = 50;
  const EnvironmentLight light(LatLong(128, 64, rgb), 2);
  const Vec3 eye = p + 700 * (2 * n.dot(source) * n - source + Vec3(0.05, 0.1, 0));
  GBuffer g{2, 1, {}, {}, {}, {}};
  for (int k = 0; k < 2; ++k) {
    for (const double each : {p.x(), p.y(), p.z(), 1.0}) g.position.push_back(static_cast<float>(each));
    for (const double each : {n.x(), n.y(), n.z(), 1.0 * k}) g.normal.push_back(static_cast<float>(each));
  }
  const std::vector<Material> materials{
      {.name = "dull", .diffuse = {0.5F, 0.25F, 0}},
      {.name = "bright", .diffuse = {0, 0, 0}, .specular = {0.2F, 0.1F, 0.4F}, .lobe = LOBE_PHONG, .shape = 20}};
  std::vector<float> seen(6);
  shade_by_environment(g, materials, light, eye, 0, 2, seen);

  const double facing = 2 * 50 * 9 * empty.solid_angle(row);
  EXPECT_NEAR(seen[1], 0.25 * std::numbers::inv_pi * light.irradiance(n)[1], 1e-6);
  EXPECT_NEAR(light.irradiance(n)[1], facing * n.dot(source), 0.1 * facing) << "the harmonics' own";
  const Eigen::Vector3f o = (eye - p).normalized().cast<float>();
  const GlossLobe lobe{o.x(), o.y(), o.z(), 20, 0.2F, 0.1F, 0.4F, LOBE_PHONG};
  EXPECT_NEAR(seen[4], light.gloss(lobe, n)[1], 1e-5 * seen[4]);
  const double there = facing * glossy_brdf(lobe, n, source)[1] * n.dot(source);
  EXPECT_NEAR(seen[4], there, 0.15 * there) << "by 40 samples";
  EXPECT_EQ(seen[3] + seen[5], 0);
}

TEST(Shading, HarmonicsBelowZeroTakeFromTheLuminairesLight) {
  // A small source at 120° from the normal, by its harmonics −4 % of what it gives a surface that faces it.
  GBuffer g{1, 1, {0, 0, 0, 1}, {0, 0, 1, 0}, {}, {}};
  const std::vector<Material> materials{{.name = "dull", .diffuse = {0.5F, 0.25F, 0}}};
  std::vector<float> rgb(3 * 64 * 32, 0.0F);
  for (std::size_t c = 0; c < 3; ++c) rgb[3 * (21 * 64 + 40) + c] = 100;
  const LatLong image(64, 32, rgb);
  const double facing = 100 * image.solid_angle(21);
  std::vector<float> light(3);
  shade_by_environment(g, materials, EnvironmentLight(image, 1), {0, 0, 500}, 0, 1, light);
  EXPECT_NEAR(light[0], -0.04 * facing * 0.5 * std::numbers::inv_pi, 0.002 * facing);
  Picture picture{1, 1, std::vector<float>(3), std::vector<float>(1), {}};
  shade(g, materials, {ScenePlacement{}}, {std::vector<double>{2}, 1}, light, picture);
  EXPECT_NEAR(picture.rgb[0], 0.5 * 2 * std::numbers::inv_pi + light[0], 1e-6);
  EXPECT_LT(picture.rgb[0], 0.5 * 2 * std::numbers::inv_pi);
}

TEST(Shading, SaysWhatIsLeftOut) {
  EXPECT_EQ(left_out(Visibility::none), "shadows, and light from surface to surface");
  EXPECT_EQ(left_out(Visibility::tile), "light from surface to surface");
  const std::string around =
      "the environment behind the scene, what hides the environment, more than nine harmonics of its diffuse light "
      "(off by −4 to +9 % of a small source's, below 0 about 120° from it), and light from surface to surface";
  EXPECT_EQ(left_out(Visibility::none, true), "shadows, " + around);
  EXPECT_EQ(left_out(Visibility::rays, true), around);
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
