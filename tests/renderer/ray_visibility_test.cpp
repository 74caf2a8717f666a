#include "renderer/visibility/ray_visibility.h"

#include <gtest/gtest.h>

#include "tests/support/meshes.h"

namespace lumifield {
namespace {

RayVisibility rays_in(const std::vector<TestTriangle>& triangles, const Pose& pose = Pose::Identity()) {
  auto made = RayVisibility::create(mesh_of(triangles, pose), pose);
  EXPECT_TRUE(made) << made.error().message();
  return std::move(*made);
}

TEST(RayVisibility, ARectangleHidesWhatTheSegmentSays) {
  std::vector<TestTriangle> triangles;
  const Vec3 corner(-130, -220, 400), a(310, 0, 60), b(-40, 290, 20);
  add_quad(triangles, corner, a, b);
  const RayVisibility rays = rays_in(triangles, tilted_pose());
  std::mt19937 random(7);
  std::uniform_real_distribution<double> unit(-1, 1);
  int hidden = 0, seen = 0;
  for (int k = 0; k < 20000; ++k) {
    const Vec3 p(600 * unit(random), 600 * unit(random), 500 + 400 * unit(random));
    const Vec3 u(40 * unit(random), 40 * unit(random), 0);
    const Vec3 n = Vec3(unit(random), unit(random), unit(random)).normalized();
    // p + t (u − p) = corner + i a + j b
    Eigen::Matrix3d m;
    m << a, b, p - u;
    const Vec3 at = m.inverse() * (p - corner);
    const double inside = std::min({at[0], 1 - at[0], at[1], 1 - at[1], at[2], 1 - at[2]});
    if (std::abs(inside) < 1e-4) continue;  // 0.03 mm, which the offset and floats may cross
    EXPECT_EQ(rays.sees(p, n, u), inside < 0) << p.transpose() << " to " << u.transpose();
    ++(inside < 0 ? seen : hidden);
  }
  EXPECT_GT(hidden, 1000);
  EXPECT_GT(seen, 10000);
}

TEST(RayVisibility, AFaceDoesNotHideItsOwnReceivers) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (const double degrees : {0.0, 45.0, 80.0, 89.0}) {
    const Eigen::AngleAxisd turn(degrees * std::numbers::pi / 180, Vec3(0.8, 0.6, 0));
    const Vec3 a = turn * Vec3(4000, 0, 0), b = turn * Vec3(0, 4000, 0), n = turn * Vec3(0, 0, 1);
    std::vector<TestTriangle> triangles;
    add_quad(triangles, Vec3(0, 0, 2500) - a / 2 - b / 2, a, b);
    const RayVisibility rays = rays_in(triangles, tilted_pose());
    EXPECT_LT(rays.offset_mm(), 0.02);
    for (int k = 0; k < 2000; ++k) {
      const Eigen::Vector3f p = (Vec3(0, 0, 2500) + unit(random) * a / 2 + unit(random) * b / 2).cast<float>();
      const Vec3 u(40 * unit(random), 40 * unit(random), 0);
      EXPECT_TRUE(rays.sees(p.cast<double>(), n, u)) << degrees << "°";
      EXPECT_TRUE(rays.sees(p.cast<double>(), -n, u)) << degrees << "°, the normal to the other side";
    }
  }
}

TEST(RayVisibility, TilesAreSeenByTheirCentres) {
  std::vector<TestTriangle> triangles;
  add_quad(triangles, {-15, -900, 100}, {40, 0, 0}, {0, 1800, 0});
  const RayVisibility rays = rays_in(triangles);
  const TileGrid grid({BasisKind::bspline2, {7.5, 6}, 38, 3, {3, -2}});  // 40 columns: two words
  TestReceivers receivers;
  receivers.add({0, 0, 300}, {0, 0, -1});
  receivers.add({60, 20, 250}, {0.6, 0, 0.8});
  receivers.add({0, 0, 300}, {0, 0, 0});
  receivers.add({0, 0, -300}, {0, 0, -1});
  const TileVisibility visible = rays.see_tiles(grid, receivers.p_xyzw, receivers.face_xyzw, ShadowWeighing::mean);
  EXPECT_EQ(visible.grid, grid);
  EXPECT_EQ(visible.weighing, ShadowWeighing::mean);
  ASSERT_EQ(visible.words.size(), 4 * visible.receiver_words());
  for (std::size_t k = 0; k < 2; ++k) {
    EXPECT_EQ(sight_of(visible, k), Sight::some);
    for (int row = 0; row < grid.rows; ++row)
      for (int column = 0; column < grid.columns; ++column) {
        const Vec2 u = grid.center_mm(column, row);
        const double x = u.x() + (receivers.p(k).x() - u.x()) * 100 / receivers.p(k).z();
        EXPECT_EQ(visible.sees(k, column, row), x < -15 || x > 25) << column << ", " << row;
      }
  }
  EXPECT_EQ(sight_of(visible, 2), Sight::none) << "background";
  EXPECT_EQ(sight_of(visible, 3), Sight::none) << "behind the lamp";
}

TEST(RayVisibility, LuminairesShareATree) {
  std::vector<TestTriangle> triangles;
  add_box(triangles, {-100, -100, 400}, {50, 100, 700});
  const Mesh mesh = mesh_of(triangles, tilted_pose());
  Pose other = tilted_pose();
  other.topLeftCorner<3, 3>() = Eigen::Matrix3d(Eigen::AngleAxisd(0.3, Vec3(0, 1, 0)) * other.topLeftCorner<3, 3>());
  other(2, 3) += 50;
  std::optional<RayVisibility> first = RayVisibility::create(mesh, tilted_pose()).value();
  const RayVisibility shared = first->at(other), own = RayVisibility::create(mesh, other).value();
  EXPECT_EQ(shared.offset_mm(), own.offset_mm());
  const auto here = surface_receivers(mesh, tilted_pose(), 500, 1), there = surface_receivers(mesh, other, 500, 1);
  const TileGrid grid({BasisKind::bell, {7.5, 6}, 6, 4, {3, -2}});
  const auto seen_here = first->see_tiles(grid, here.p_xyzw, here.face_xyzw).words;
  first.reset();
  const auto seen_there = shared.see_tiles(grid, there.p_xyzw, there.face_xyzw).words;
  EXPECT_EQ(seen_there, own.see_tiles(grid, there.p_xyzw, there.face_xyzw).words);
  EXPECT_NE(seen_there, seen_here);
}

TEST(RayVisibility, AnEmptySceneHidesNothing) {
  const RayVisibility rays = rays_in({});
  EXPECT_TRUE(rays.sees({0, 0, 500}, {0, 0, -1}, {0, 0, 0}));
}

}  // namespace
}  // namespace lumifield
