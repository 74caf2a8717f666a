#include "renderer/opengl/gbuffer.h"

#include <Eigen/Geometry>
#include <cmath>
#include <cstdlib>
#include <gtest/gtest.h>
#include <numbers>

#include "renderer/renderer.h"
#include "tests/support/egl_fixture.h"

namespace lumifield {
namespace {

using Triangle = std::array<Vec3, 3>;

/// One material a triangle, with the triangle's own normal.
Mesh mesh_of(const std::vector<Triangle>& triangles) {
  Mesh mesh;
  for (const Triangle& t : triangles) {
    const Eigen::Vector3f n = (t[1] - t[0]).cross(t[2] - t[0]).normalized().cast<float>();
    for (const Vec3& p : t) {
      const Eigen::Vector3f q = p.cast<float>();
      mesh.vertices.push_back({{q.x(), q.y(), q.z()}, {n.x(), n.y(), n.z()}});
    }
    mesh.material.push_back(static_cast<std::uint32_t>(mesh.materials.size()));
    mesh.materials.push_back({.name = "m"});
  }
  return mesh;
}

/// The ray through a pixel's centre, top row first, written apart from the renderer's.
Vec3 ray(const SceneCamera& camera, int width, int height, int x, int y) {
  const Vec3 forward = (camera.target_mm - camera.position_mm).normalized();
  const Vec3 right = forward.cross(camera.up).normalized();
  const Vec3 down = forward.cross(right);
  const double pixel = 2 * std::tan(camera.fov_y_deg / 2 * std::numbers::pi / 180) / height;
  return forward + right * (pixel * (x + 0.5 - width / 2.0)) + down * (pixel * (y + 0.5 - height / 2.0));
}

struct Seen {
  Vec3 p, n, face;
  double coverage, material;
};
Seen at(const GBuffer& g, int x, int y) {
  const std::size_t i =
      4 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(g.width_px) + static_cast<std::size_t>(x));
  return {{g.position[i], g.position[i + 1], g.position[i + 2]},
          {g.normal[i], g.normal[i + 1], g.normal[i + 2]},
          {g.face[i], g.face[i + 1], g.face[i + 2]},
          g.position[i + 3],
          g.normal[i + 3]};
}

class GBufferTest : public test::WithEgl {
 protected:
  GBuffer draw(const Mesh& mesh, const SceneCamera& camera, int width, int height) {
    auto pass = GBufferPass::create(*context_, mesh);
    EXPECT_TRUE(pass) << pass.error().message();
    auto drawn = (*pass)->draw(camera, width, height);
    EXPECT_TRUE(drawn) << drawn.error().message();
    return *drawn;
  }
};

TEST_F(GBufferTest, PositionsAreTheRaysHitsOnASlantedTriangle) {
  const Triangle t = {Vec3(-900, 1500, -700), Vec3(1100, 2600, -500), Vec3(100, 1900, 1200)};
  SceneCamera camera;
  camera.position_mm = {123.456, -80.25, 60.5};
  camera.target_mm = {0, 1700, 10};
  const int width = 161, height = 120;
  const GBuffer g = draw(mesh_of({t}), camera, width, height);

  const Vec3 n = (t[1] - t[0]).cross(t[2] - t[0]);
  int covered = 0;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const Vec3 d = ray(camera, width, height, x, y);
      const Vec3 hit = camera.position_mm + d * (n.dot(t[0] - camera.position_mm) / n.dot(d));
      // How far inside all three edges, as a barycentric coordinate.
      double inside = INFINITY;
      for (std::size_t k = 0; k < 3; ++k)
        inside = std::min(inside, (t[(k + 1) % 3] - t[k]).cross(hit - t[k]).dot(n) / n.squaredNorm());
      const Seen seen = at(g, x, y);
      if (std::abs(inside) < 1e-3) continue;  // the edge itself: the rasteriser's choice
      ASSERT_EQ(seen.coverage, inside > 0 ? 1 : 0) << x << ", " << y;
      if (inside < 0) {
        EXPECT_EQ(seen.p, Vec3::Zero());
        EXPECT_EQ(seen.n, Vec3::Zero());
        continue;
      }
      ++covered;
      for (int k = 0; k < 3; ++k) EXPECT_NEAR(seen.p[k], hit[k], 1e-7 * hit.norm()) << x << ", " << y;
      EXPECT_LT((seen.n - (n.dot(d) < 0 ? 1 : -1) * n.normalized()).norm(), 2e-7);
      EXPECT_LT((seen.face - (n.dot(d) < 0 ? 1 : -1) * n.normalized()).norm(), 2e-7);
    }
  EXPECT_GT(covered, 3000);
}

TEST_F(GBufferTest, NormalsOfAPlaneAreExactAndFaceTheEyeFromBothSides) {
  const std::vector<Triangle> floor = {{Vec3(-5000, -5000, 0), Vec3(5000, -5000, 0), Vec3(5000, 5000, 0)},
                                       {Vec3(-5000, -5000, 0), Vec3(5000, 5000, 0), Vec3(-5000, 5000, 0)}};
  SceneCamera camera;
  camera.up = {0, 1, 0};
  for (const double side : {1.0, -1.0}) {
    camera.position_mm = {10, 20, 1000 * side};
    camera.target_mm = {10, 20, 0};
    const GBuffer g = draw(mesh_of(floor), camera, 64, 48);
    for (int y = 0; y < 48; ++y)
      for (int x = 0; x < 64; ++x) {
        ASSERT_EQ(at(g, x, y).coverage, 1) << "a crack at " << x << ", " << y;
        ASSERT_EQ(at(g, x, y).n, Vec3(0, 0, side));
        ASSERT_EQ(at(g, x, y).p.z(), 0);
      }
  }
}

TEST_F(GBufferTest, TheFirstRowIsTheTopAndTheNearerTriangleWins) {
  // Triangle 0 lies above and to the left; 1 behind it and everywhere.
  const Mesh mesh = mesh_of({{Vec3(-400, 1000, 50), Vec3(-50, 1000, 50), Vec3(-400, 1000, 400)},
                             {Vec3(-9000, 1000.001, -9000), Vec3(9000, 1000.001, -9000), Vec3(0, 1000.001, 9000)}});
  SceneCamera camera;
  camera.target_mm = {0, 1, 0};
  const GBuffer g = draw(mesh, camera, 40, 40);
  EXPECT_EQ(at(g, 8, 14).material, 0);
  EXPECT_EQ(at(g, 31, 14).material, 1);
  EXPECT_EQ(at(g, 8, 25).material, 1);
  EXPECT_GT(at(g, 0, 0).p.z(), 0);
  EXPECT_LT(at(g, 0, 0).p.x(), 0);
}

TEST_F(GBufferTest, VertexNormalsAreInterpolated) {
  Mesh mesh = mesh_of({{Vec3(-1000, 1000, -1000), Vec3(3000, 1000, -1000), Vec3(-1000, 1000, 3000)}});
  mesh.vertices[0].normal = {-0.6F, -0.8F, 0};
  mesh.vertices[1].normal = {0.6F, -0.8F, 0};
  mesh.vertices[2].normal = {0, -1, 0};
  SceneCamera camera;
  camera.target_mm = {0, 1, 0};
  const GBuffer g = draw(mesh, camera, 32, 32);
  for (int x = 0; x < 32; x += 5) {
    const Seen seen = at(g, x, 7);
    const double b1 = (seen.p.x() + 1000) / 4000, b2 = (seen.p.z() + 1000) / 4000;
    const Vec3 n = (1 - b1 - b2) * Vec3(-0.6, -0.8, 0) + b1 * Vec3(0.6, -0.8, 0) + b2 * Vec3(0, -1, 0);
    EXPECT_LT((seen.n - n.normalized()).norm(), 1e-6);
    EXPECT_EQ(seen.face, Vec3(0, -1, 0));
  }
  EXPECT_TRUE(g.reflectance.empty());
}

/// A wall of 2 m, seen straight on, that shows its texture twice in width and once in height; one beside it without.
Mesh textured_wall() {
  const Vec3 a(-1000, 1000, -1000), b(1000, 1000, -1000), c(1000, 1000, 1000), d(-1000, 1000, 1000),
      e(3000, 1000, -1000), f(3000, 1000, 1000);
  Mesh mesh = mesh_of({{a, b, c}, {a, c, d}, {b, e, f}});
  const auto uv = [&](std::size_t k, const Vec3& p) {
    mesh.vertices[k].uv = {static_cast<float>((p.x() + 1000) / 1000), static_cast<float>((p.z() + 1000) / 2000)};
  };
  for (const auto& [k, p] : {std::pair(0, a), {1, b}, {2, c}, {3, a}, {4, c}, {5, d}})
    uv(static_cast<std::size_t>(k), p);
  mesh.materials[0].texture = mesh.materials[1].texture = 0;
  mesh.materials[0].diffuse = mesh.materials[1].diffuse = {0.5F, 1, 1};
  mesh.materials[2].diffuse = {0.25F, 0.5F, 0.75F};
  return mesh;
}

TEST_F(GBufferTest, TexturesAreInterpolatedRepeatedAndStandUpright) {
  // Four texels, brighter to the right in red and downwards in green.
  Mesh mesh = textured_wall();
  mesh.textures = {{2, 2, {0.2F, 0.1F, 0.5F, 0.6F, 0.1F, 0.5F, 0.2F, 0.9F, 0.5F, 0.6F, 0.9F, 0.5F}, {}}};
  SceneCamera camera;
  camera.target_mm = {0, 1, 0};
  camera.fov_y_deg = 60;
  const int width = 320, height = 240;
  const GBuffer g = draw(mesh, camera, width, height);
  ASSERT_EQ(g.reflectance.size(), g.position.size());
  // Between texels' centres, at ¼ and ¾, the colour is linear and periodic.
  const auto tent = [](double x) { return std::abs(2 * (x - 0.25 - std::floor(x - 0.25)) - 1); };
  int walls = 0;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const Seen seen = at(g, x, y);
      const float* r = &g.reflectance[4 * static_cast<std::size_t>(y * width + x)];
      if (seen.coverage == 0 || seen.material == 2) {
        EXPECT_EQ(r[0], seen.coverage == 0 ? 0 : 0.25F);
        EXPECT_EQ(r[2], seen.coverage == 0 ? 0 : 0.75F);
        continue;
      }
      ++walls;
      const double red = 0.6 - 0.4 * tent((seen.p.x() + 1000) / 1000);
      const double green = 0.1 + 0.8 * tent((seen.p.z() + 1000) / 2000);
      ASSERT_NEAR(r[0], 0.5 * red, 0.5 * 0.4 / 128) << "weights of 8 bits: " << x << ", " << y;
      ASSERT_NEAR(r[1], green, 0.8 / 128) << x << ", " << y;
      ASSERT_NEAR(r[2], 0.5, 1e-6);
    }
  EXPECT_GT(walls, 10000);
}

TEST_F(GBufferTest, FarTexturesAreTheirMean) {
  Mesh mesh = textured_wall();
  Texture& t = mesh.textures.emplace_back(Texture{256, 256, std::vector<float>(3 * 256 * 256), {}});
  for (std::size_t k = 0; k < t.rgb.size(); ++k) t.rgb[k] = static_cast<float>((k / 3 + k / 768) % 2);  // a chess board
  SceneCamera camera;
  camera.position_mm = {0, -40000, 0};
  camera.target_mm = {0, 1, 0};
  const GBuffer g = draw(mesh, camera, 400, 300);
  int inside = 0;
  for (int y = 0; y < 300; ++y)
    for (int x = 0; x < 400; ++x) {
      if (at(g, x, y).coverage == 0 || at(g, x, y).material == 2) continue;
      ++inside;
      // Pixels of the edge too: the texture's scale is that of the plane.
      EXPECT_NEAR(g.reflectance[4 * static_cast<std::size_t>(400 * y + x) + 1], 0.5, 0.01) << x << ", " << y;
    }
  EXPECT_GT(inside, 200);
}

TEST_F(GBufferTest, RefusesSizesAndCamerasWithoutSense) {
  auto pass = GBufferPass::create(*context_, mesh_of({{Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)}}));
  ASSERT_TRUE(pass);
  SceneCamera camera;
  camera.target_mm = {0, 1, 0};
  EXPECT_FALSE((*pass)->draw(camera, 0, 10));
  EXPECT_FALSE((*pass)->draw(camera, 10, max_picture_px + 1));
  SceneCamera broken = camera;
  broken.target_mm = broken.position_mm;
  EXPECT_EQ((*pass)->draw(broken, 8, 8).error().where, "camera");
  broken.target_mm = {0, 0, 5};
  EXPECT_FALSE((*pass)->draw(broken, 8, 8)) << "up along the view";
  broken = camera;
  broken.fov_y_deg = 180;
  EXPECT_FALSE((*pass)->draw(broken, 8, 8));
  broken.fov_y_deg = NAN;
  EXPECT_FALSE((*pass)->draw(broken, 8, 8));
  EXPECT_TRUE((*pass)->draw(camera, 8, 8));
}

TEST_F(GBufferTest, TwoContextsOfOneThreadDoNotDisturbEachOther) {
  const Mesh mesh = mesh_of({{Vec3(-900, 500, -700), Vec3(900, 500, -700), Vec3(0, 500, 900)}});
  SceneCamera camera;
  camera.target_mm = {0, 1, 0};
  auto pass = GBufferPass::create(*context_, mesh);
  ASSERT_TRUE(pass);
  {
    auto other = EglContext::create();
    ASSERT_TRUE(other);
    auto other_pass = GBufferPass::create(**other, mesh);
    ASSERT_TRUE(other_pass);
    const auto first = (*pass)->draw(camera, 20, 20), second = (*other_pass)->draw(camera, 20, 20);
    ASSERT_TRUE(first && second);
    EXPECT_EQ(first->position, second->position);
  }
  EXPECT_TRUE((*pass)->draw(camera, 20, 20));
}

TEST(OpenGl, WithoutADriverTheProbeSaysWhyAndWhatToDo) {
  testing::FLAGS_gtest_death_test_style = "threadsafe";
  EXPECT_EXIT(
      {
        setenv("__EGL_VENDOR_LIBRARY_FILENAMES", "/nonexistent/vendor.json", 1);
        const auto probed = probe_opengl();
        if (probed) std::exit(1);
        std::fputs(probed.error().message().c_str(), stderr);
        std::exit(0);
      },
      testing::ExitedWithCode(0), "OpenGL: no context.*install an OpenGL driver");
}

}  // namespace
}  // namespace lumifield
