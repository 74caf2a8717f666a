#include <cmath>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "renderer/visibility/shadow_map_pass.h"
#include "renderer/visibility/shadow_mesh.h"
#include "tests/support/egl_fixture.h"
#include "tests/support/meshes.h"

namespace lumifield {
namespace {

using testing::HasSubstr;

/// What depth is claimed to, relative.
constexpr double claimed = 1e-5;

Vec3 direction(const ShadowView& view, int size_px, int i, int j) {
  const Vec2 t = view.low + (view.high - view.low).cwiseProduct(Vec2(i + 0.5, j + 0.5)) / size_px;
  return {t.x(), t.y(), 1};
}

float depth_at(const ShadowMaps& maps, std::size_t map, int i, int j) {
  return maps.depth_mm[map * maps.texels() + static_cast<std::size_t>(j * maps.size_px + i)];
}

class ShadowMapsTest : public test::WithEgl {
 protected:
  ShadowMaps draw(const std::vector<TestTriangle>& triangles, const std::vector<ShadowView>& views, int size_px,
                  const Pose& pose = Pose::Identity()) {
    auto pass = ShadowMapPass::create(*context_, mesh_of(triangles, pose));
    EXPECT_TRUE(pass) << pass.error().message();
    auto drawn = (*pass)->draw(pose, views, size_px);
    EXPECT_TRUE(drawn) << drawn.error().message();
    return *drawn;
  }
};

const ShadowView to_the_side = {{12, -7, 0}, {-0.4, -1.3}, {1.1, 0.2}};

TEST_F(ShadowMapsTest, DepthOfObliquePlanesIsTheRays) {
  const Pose pose = tilted_pose();
  for (const double degrees : {0.0, 30.0, 60.0, 80.0, 85.0}) {
    // Through (0, 0, 1500), turned about an axis in the plane of x and y.
    const Eigen::AngleAxisd turn(degrees * std::numbers::pi / 180, Vec3(0.8, 0.6, 0));
    const Vec3 a = turn * Vec3(40000, 0, 0), b = turn * Vec3(0, 40000, 0), n = turn * Vec3(0, 0, 1);
    std::vector<TestTriangle> triangles;
    add_quad(triangles, Vec3(0, 0, 1500) - a / 2 - b / 2, a, b);
    const std::vector<ShadowView> views = {to_the_side, {{-30, 20, 150}, {-0.2, -0.2}, {0.3, 0.3}}};
    const ShadowMaps maps = draw(triangles, views, 192, pose);
    double worst = 0;
    int covered = 0;
    for (std::size_t k = 0; k < 2; ++k)
      for (int j = 0; j < 192; ++j)
        for (int i = 0; i < 192; ++i) {
          const Vec3 e = views[k].eye_mm;
          const double z = n.dot(Vec3(0, 0, 1500) - e) / n.dot(direction(views[k], 192, i, j));
          const float depth = depth_at(maps, k, i, j);
          if (z < 0 || z > 15000) continue;  // beyond the square
          ASSERT_TRUE(std::isfinite(depth)) << degrees << "° at " << i << ", " << j;
          worst = std::max(worst, std::abs(depth - z) / z);
          ++covered;
        }
    EXPECT_GT(covered, 30000) << degrees;
    EXPECT_LT(worst, claimed) << degrees;
  }
}

TEST_F(ShadowMapsTest, DepthOfASphereIsTheRays) {
  constexpr double radius = 400;
  constexpr int parts = 200;
  const Vec3 center(150, -300, 1300);
  std::vector<TestTriangle> triangles;
  add_sphere(triangles, center, radius, parts);
  const ShadowMaps maps = draw(triangles, {to_the_side}, 192, tilted_pose());

  // A facet lies below its sphere by up to its sagitta, as far as its corners are from its middle. The rasteriser may
  // take the next facet up to 1/256 texel, of 8 mm at 1000 mm, beyond their edge, of which its nearest point counts.
  const double sagitta = radius * (1 - std::cos(std::numbers::sqrt2 * std::numbers::pi / parts / 2));
  int hit = 0, missed = 0, at_edges = 0;
  for (int j = 0; j < 192; ++j)
    for (int i = 0; i < 192; ++i) {
      const Vec3 d = direction(to_the_side, 192, i, j), to = center - to_the_side.eye_mm;
      const double along = d.dot(to) / d.squaredNorm(), off = (along * d - to).norm();
      const float depth = depth_at(maps, 0, i, j);
      if (off > radius) {
        ++missed;
        EXPECT_EQ(depth, INFINITY) << i << ", " << j;
      }
      const double incidence = std::sqrt(std::max(0.0, 1 - off * off / radius / radius));
      if (incidence < 0.2) continue;  // the facets' edge is not the sphere's
      const double z = along - incidence * radius / d.norm();
      ++hit;
      const double step = 8.0 / 256 * z / 1000 / incidence;
      EXPECT_GE(depth, z * (1 - claimed) - step);
      EXPECT_LE(depth, z * (1 + claimed) + step + sagitta / incidence / d.norm());
      at_edges += depth < z * (1 - claimed);
    }
  EXPECT_GT(hit, 3000);
  EXPECT_LT(at_edges, hit / 100) << "some 3 edges a texel, each 2/256 wide, half of them nearer";
  EXPECT_GT(missed, 3000);
}

TEST_F(ShadowMapsTest, TexelsStandWhereTheirDirectionsSay) {
  // A rectangle right and below of the axis, as seen off axis, in one map of several.
  std::vector<TestTriangle> triangles;
  add_quad(triangles, {300, -700, 1000}, {200, 0, 0}, {0, 450, 0});
  const ShadowView away = {{0, 0, 0}, {-2, 1}, {-1, 2}};
  const ShadowMaps maps = draw(triangles, {away, to_the_side, away}, 100);
  int covered = 0;
  for (int j = 0; j < 100; ++j)
    for (int i = 0; i < 100; ++i) {
      EXPECT_EQ(depth_at(maps, 0, i, j), INFINITY);
      EXPECT_EQ(depth_at(maps, 2, i, j), INFINITY);
      const Vec3 at = to_the_side.eye_mm + 1000 * direction(to_the_side, 100, i, j);
      const double inside = std::min({at.x() - 300, 500 - at.x(), at.y() + 700, -250 - at.y()});
      // The rasteriser's steps of 1/256 texel, of 15 mm.
      if (std::abs(inside) < 15.0 / 256) continue;
      EXPECT_EQ(depth_at(maps, 1, i, j), inside > 0 ? 1000 : INFINITY) << i << ", " << j;
      covered += inside > 0;
    }
  EXPECT_GT(covered, 300);
}

TEST_F(ShadowMapsTest, BothSidesAreSurfacesAndNothingBehindTheEyeIsOne) {
  const TestTriangle t = {Vec3(-900, -900, 700), Vec3(1200, -800, 900), Vec3(100, 1500, 1100)};
  const TestTriangle behind = {Vec3(-900, -900, -700), Vec3(1200, -800, -900), Vec3(100, 1500, -1100)};
  const ShadowMaps one = draw({t}, {to_the_side}, 64);
  EXPECT_EQ(one.depth_mm, draw({{t[1], t[0], t[2]}}, {to_the_side}, 64).depth_mm);
  EXPECT_EQ(one.depth_mm, draw({t, behind}, {to_the_side}, 64).depth_mm);

  // One that reaches from behind the eye to before it: where it is before it, the plane's depth.
  const TestTriangle across = {Vec3(-2000, -300, -2000), Vec3(2000, -300, -2000), Vec3(0, -300, 9000)};
  const ShadowMaps floor = draw({across}, {to_the_side}, 64);
  int covered = 0;
  for (int j = 0; j < 64; ++j)
    for (int i = 0; i < 64; ++i) {
      const Vec3 d = direction(to_the_side, 64, i, j);
      const double z = (-300 - to_the_side.eye_mm.y()) / d.y();
      const double half = 2000 * (9000 - z) / 11000, x = to_the_side.eye_mm.x() + z * d.x();
      if (z > 0 && std::abs(x) < half - 20) {
        ++covered;
        EXPECT_NEAR(depth_at(floor, 0, i, j), z, claimed * z);
      } else if (z < 0 || std::abs(x) > half + 20) {
        EXPECT_EQ(depth_at(floor, 0, i, j), INFINITY);
      }
    }
  EXPECT_GT(covered, 1000);
}

TEST_F(ShadowMapsTest, OfTwoThatAlmostTouchFarAwayTheNearerIsKept) {
  std::vector<TestTriangle> triangles;
  for (const double z : {8000.0, 8000.004}) add_quad(triangles, {-20000, -20000, z}, {40000, 0, 0}, {0, 40000, 0});
  for (int turn = 0; turn < 2; ++turn) {
    const ShadowMaps maps = draw(triangles, {to_the_side}, 64);
    for (const float depth : maps.depth_mm) ASSERT_EQ(depth, 8000);
    std::ranges::reverse(triangles);
  }
}

TEST_F(ShadowMapsTest, MoreMapsThanAColumnHoldsAreAllThere) {
  std::vector<TestTriangle> triangles;
  std::vector<ShadowView> views;
  add_quad(triangles, {-20000, -20000, 1000}, {40000, 0, 0}, {0, 40000, 0});
  for (int k = 0; k < 1100; ++k) views.push_back({{0, 0, k * 0.5}, {-1, -1}, {1, 1}});
  const ShadowMaps maps = draw(triangles, views, 32);  // 16384/32 = 512
  for (std::size_t k = 0; k < views.size(); ++k)
    for (const std::size_t texel : {std::size_t(0), maps.texels() - 1})
      ASSERT_EQ(maps.depth_mm[k * maps.texels() + texel], 1000 - 0.5F * static_cast<float>(k));
}

TEST_F(ShadowMapsTest, AnotherPoseMovesTheSceneAndThePassesOfAContextAgree) {
  std::vector<TestTriangle> triangles;
  add_quad(triangles, {-900, -900, 1000}, {1800, 0, 0}, {0, 1800, 0});
  const Mesh mesh = mesh_of(triangles);
  auto pass = ShadowMapPass::create(*context_, mesh);
  auto other = ShadowMapPass::create(*context_, mesh);
  ASSERT_TRUE(pass && other);
  const std::vector<ShadowView> views = {{{0, 0, 0}, {-1, -1}, {1, 1}}};
  Pose back = Pose::Identity();
  back(2, 3) = -500;
  for (int k = 0; k < 2; ++k) {
    EXPECT_EQ(depth_at(*(*pass)->draw(Pose::Identity(), views, 16), 0, 8, 8), 1000);
    EXPECT_EQ(depth_at(*(*other)->draw(back, views, 16), 0, 8, 8), 1500);
    EXPECT_EQ(depth_at(*(*pass)->draw(back, views, 16), 0, 8, 8), 1500);
  }
}

TEST_F(ShadowMapsTest, RefusesWhatIsTooLargeOrHasNoSize) {
  auto pass = ShadowMapPass::create(*context_, mesh_of({{Vec3(0, 0, 9), Vec3(1, 0, 9), Vec3(0, 1, 9)}}));
  ASSERT_TRUE(pass);
  const auto refusal = [&](const std::vector<ShadowView>& views, int size_px) {
    const auto drawn = (*pass)->draw(Pose::Identity(), views, size_px);
    return drawn ? "drawn" : drawn.error().message();
  };
  EXPECT_THAT(refusal({{}}, 0), HasSubstr("0 texels a side"));
  EXPECT_THAT(refusal({{}}, 1 << 20), HasSubstr("1048576 texels a side"));
  // 129 of 4 MiB are more than 512 MiB.
  EXPECT_THAT(refusal(std::vector<ShadowView>(129), 1024), HasSubstr("more tiles per map"));
  EXPECT_THAT(refusal({{}, {{0, 0, 0}, {1, 0}, {1, 1}}}, 8), HasSubstr("shadow map 1"));
  EXPECT_THAT(refusal({{{NAN, 0, 0}, {-1, -1}, {1, 1}}}, 8), HasSubstr("shadow map 0"));
  EXPECT_EQ(refusal({}, 8), "drawn");
  EXPECT_EQ(refusal({{}}, 8), "drawn");
}

TEST(ShadowMesh, KeepsTheTrianglesWithFewVertices) {
  std::vector<TestTriangle> triangles;
  add_sphere(triangles, {100, 0, 1000}, 300, 30);  // its poles have triangles without an area
  const Mesh mesh = mesh_of(triangles);
  const ShadowMesh kept(mesh);
  EXPECT_EQ(kept.triangles(), triangles.size() - 2 * 60);
  EXPECT_LT(kept.vertices.size(), kept.triangles() + kept.triangles() / 50);
  const auto area = [](const Vec3& a, const Vec3& b, const Vec3& c) { return (b - a).cross(c - a); };
  const auto at = [&](std::size_t k) {
    const auto& p = kept.vertices[kept.corners[k]];
    return Vec3(p[0], p[1], p[2]);
  };
  Vec3 moment = Vec3::Zero(), expected = Vec3::Zero();
  for (std::size_t k = 0; k < kept.triangles(); ++k) {
    EXPECT_EQ(kept.corners[3 * k + 2], k) << "the last corner is its own";
    moment += area(at(3 * k), at(3 * k + 1), at(3 * k + 2)).cwiseProduct(at(3 * k) + at(3 * k + 1) + at(3 * k + 2));
  }
  for (const TestTriangle& t : triangles) expected += area(t[0], t[1], t[2]).cwiseProduct(t[0] + t[1] + t[2]);
  EXPECT_LT((moment - expected).norm(), 1e-4 * expected.norm()) << "each with its corners in order";
}

}  // namespace
}  // namespace lumifield
