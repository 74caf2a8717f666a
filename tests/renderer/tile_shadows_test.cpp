#include "renderer/visibility/tile_shadows.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "renderer/opencl/device.h"
#include "renderer/renderer.h"
#include "renderer/visibility/ray_visibility.h"
#include "renderer/visibility/tile_visibility_shared.h"
#include "tests/support/egl_fixture.h"
#include "tests/support/kernel_layout.h"
#include "tests/support/meshes.h"

namespace lumifield {
namespace {

using testing::HasSubstr;

/// 10×8 tiles.
const LuminaireGeometry bike = {
    {150}, {BasisKind::bell, {7.5, 7.5}, 9, 7, {0, 0}}, {300, 300, {1, 1}, {0, 0}}, {"Y"}, Quantity::relative};

/// Every tile's light at its own place.
TilePositions positions_on(const LuminaireGeometry& geometry) {
  TilePositions positions{TileGrid(geometry.sampling), {}};
  for (int k = 0; k < positions.grid.tiles(); ++k)
    positions.on_s_mm.push_back(k % 7 == 3 ? std::nullopt : std::optional(Vec2(k % 13 * 9.0 - 50, k % 5 * 11.0 - 20)));
  return positions;
}

class TileShadowsTest : public test::WithEgl {
 protected:
  void SetUp() override {
    WithEgl::SetUp();
    if (IsSkipped()) return;
    if (const auto opencl = probe_opencl(); !opencl) GTEST_SKIP() << opencl.error().message();
  }
  std::unique_ptr<TileShadows> shadows_in(const Mesh& mesh) {
    auto made = TileShadows::create(*context_, mesh);
    EXPECT_TRUE(made) << made.error().message();
    return std::move(*made);
  }
  TileVisibility see(TileShadows& shadows, const TestReceivers& receivers) {
    auto seen = shadows.see(receivers.p_xyzw, receivers.face_xyzw);
    EXPECT_TRUE(seen) << seen.error().message();
    return *seen;
  }
};

int not_seen(const TileVisibility& visible, std::size_t receivers) {
  int hidden = 0;
  for (std::size_t k = 0; k < receivers; ++k) hidden += sight_of(visible, k) != Sight::all;
  return hidden;
}

TEST_F(TileShadowsTest, ALitPlaneSeesEveryTile) {
  const Pose pose = tilted_pose();
  std::mt19937 random(11);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (const ShadowPosition position : {ShadowPosition::tile_center, ShadowPosition::published})
    for (const double degrees : {0.0, 20.0, 45.0, 60.0, 70.0, 80.0, 85.0}) {
      const Eigen::AngleAxisd turn(degrees * std::numbers::pi / 180, Vec3(0.8, 0.6, 0));
      const Vec3 middle(0, 0, 1500), a = turn * Vec3(40000, 0, 0), b = turn * Vec3(0, 40000, 0);
      const Vec3 n = turn * Vec3(0, 0, 1);
      std::vector<TestTriangle> triangles;
      add_quad(triangles, middle - a / 2 - b / 2, a, b);
      auto shadows = shadows_in(mesh_of(triangles, pose));
      ASSERT_TRUE(shadows->set(pose, bike, {.position = position}, positions_on(bike)));
      TestReceivers receivers;
      while (receivers.size() < 5000) {
        const Vec3 d(unit(random), unit(random), 1);
        const double z = n.dot(middle) / n.dot(d);
        if (!(z > 200 && z < 12000) || std::abs(n.dot(d.normalized())) < std::cos(85.5 * std::numbers::pi / 180))
          continue;
        receivers.add(z * d, unit(random) < 0 ? n : Vec3(-n));
      }
      EXPECT_EQ(not_seen(see(*shadows, receivers), receivers.size()), 0) << degrees << "°";
    }
}

TEST_F(TileShadowsTest, ALitCylindersFacetsSeeEveryTile) {
  const Pose pose = tilted_pose();
  std::vector<TestTriangle> triangles;
  const Vec3 foot(60, -600, 1400);
  add_cylinder(triangles, foot, 250, 1200, 48);
  auto shadows = shadows_in(mesh_of(triangles, pose));
  ASSERT_TRUE(shadows->set(pose, bike, {}));
  std::mt19937 random(5);
  std::uniform_real_distribution<double> unit(0, 1);
  TestReceivers receivers;
  while (receivers.size() < 20000) {
    const auto& t = triangles[static_cast<std::size_t>(unit(random) * static_cast<double>(triangles.size()))];
    const double a = std::sqrt(unit(random)), b = unit(random);
    const Vec3 p = (1 - a) * t[0] + a * (1 - b) * t[1] + a * b * t[2];
    Vec3 n = (t[1] - t[0]).cross(t[2] - t[0]).normalized();
    if (n.dot(p - foot) < 0) n = -n;
    // Lit by all tiles at less than 85°.
    bool lit = true;
    for (const double x : {-33.75, 33.75})
      for (const double y : {-26.25, 26.25})
        lit &= n.dot((Vec3(x, y, 0) - p).normalized()) > std::cos(85 * std::numbers::pi / 180);
    if (lit) receivers.add(p, n);
  }
  EXPECT_EQ(not_seen(see(*shadows, receivers), receivers.size()), 0);
}

TEST_F(TileShadowsTest, AShadowStandsOnTheFeetOfWhatThrowsIt) {
  // A wall without a thickness and a box, on a floor below the axis; receivers on the floor behind them.
  struct Case {
    double depth_mm;
    const char* name;
  };
  for (const auto& [depth_mm, name] : {Case{0, "wall"}, Case{200, "box"}}) {
    constexpr double floor_y = -400, foot_z = 1200;
    std::vector<TestTriangle> triangles;
    add_quad(triangles, {-4000, floor_y, 200}, {8000, 0, 0}, {0, 0, 5000});
    if (depth_mm == 0)
      add_quad(triangles, {-500, floor_y, foot_z}, {1000, 0, 0}, {0, 300, 0});
    else
      add_box(triangles, {-500, floor_y, foot_z - depth_mm}, {500, floor_y + 300, foot_z});
    auto shadows = shadows_in(mesh_of(triangles));
    ASSERT_TRUE(shadows->set(Pose::Identity(), bike, {}));
    std::mt19937 random(9);
    std::uniform_real_distribution<double> unit(0, 1);
    TestReceivers receivers;
    for (int k = 0; k < 40000; ++k)
      receivers.add({400 * (2 * unit(random) - 1), floor_y, foot_z + 0.5 + 60 * unit(random) * unit(random)},
                    {0, 1, 0});
    const TileVisibility visible = see(*shadows, receivers);
    const auto plan = plan_shadows(bike, {}, std::nullopt);
    ASSERT_TRUE(plan);
    double farthest = 0;
    int leaks = 0;
    for (std::size_t k = 0; k < receivers.size(); ++k)
      for (int row = 0; row < 8; ++row)
        for (int column = 0; column < 10; ++column) {
          if (!visible.sees(k, column, row)) continue;
          const ShadowView& view = plan->views[static_cast<std::size_t>(row * 10 + column)];
          const double down = floor_y - view.eye_mm.y(), texel = (view.high.y() - view.low.y()) / 192;
          farthest = std::max(farthest, (down / receivers.p(k).z() - down / foot_z) / texel);
          ++leaks;
        }
    RecordProperty(std::string(name) + "_leaks", leaks);
    RecordProperty(std::string(name) + "_leak_texels", std::to_string(farthest));
    // A texel across the foot has the floor's depth where its centre is before it: a wall leaks there, up to half a
    // texel behind it, and where a centre is behind it by no more than the bias. A box hides what is behind it by its
    // height.
    const ShadowView& view = plan->views[0];
    const double bias = bias_of(view, {}) * (view.eye_mm.y() - floor_y) / foot_z * 192 / (view.high.y() - view.low.y());
    if (depth_mm == 0)
      EXPECT_LT(farthest, 0.51 + bias);
    else
      EXPECT_EQ(leaks, 0);
  }
}

TEST_F(TileShadowsTest, ReceiversWithoutAFaceOrBehindTheLampSeeNothing) {
  auto shadows = shadows_in(mesh_of({{Vec3(-9, 0, 900), Vec3(9, 0, 900), Vec3(0, 9, 900)}}));
  ASSERT_TRUE(shadows->set(Pose::Identity(), bike, {.weighing = ShadowWeighing::mean}));
  TestReceivers receivers;
  receivers.add({500, 0, 1000}, {0, 0, 0});
  receivers.add({0, 0, -1000}, {0, 0, 1});
  receivers.add({0, 0, 0}, {0, 0, 1});
  receivers.add({500, 0, 1000}, {0, 0, -1});
  receivers.add({1e5, 0, 10}, {0, 0, -1});  // far beside all maps
  receivers.add({0, 4, 1000}, {0, 0, -1});  // behind the triangle
  const TileVisibility visible = see(*shadows, receivers);
  EXPECT_EQ(visible.weighing, ShadowWeighing::mean);
  EXPECT_EQ(visible.grid, TileGrid(bike.sampling));
  ASSERT_EQ(visible.words.size(), 6 * visible.receiver_words());
  for (std::size_t k = 0; k < 3; ++k) EXPECT_EQ(sight_of(visible, k), Sight::none) << k;
  EXPECT_EQ(sight_of(visible, 3), Sight::all);
  EXPECT_EQ(sight_of(visible, 4), Sight::all);
  EXPECT_EQ(sight_of(visible, 5), Sight::some);
  for (std::size_t k = 0; k < visible.words.size(); ++k) EXPECT_EQ(visible.words[k] >> 10, 0U) << "beyond the grid";
}

TEST_F(TileShadowsTest, MapsAreMadeOnlyWhenSomethingHasChanged) {
  auto shadows = shadows_in(mesh_of({{Vec3(-900, -900, 900), Vec3(900, -900, 900), Vec3(0, 900, 900)}}));
  EXPECT_FALSE(shadows->see({}, {})) << "no light yet";
  Pose pose = Pose::Identity();
  LuminaireGeometry lamp = bike;
  ShadowSettings settings;
  std::optional<TilePositions> positions = positions_on(bike);
  int made = 0;
  const auto set = [&](bool anew, const char* what) {
    ASSERT_TRUE(shadows->set(pose, lamp, settings, positions));
    EXPECT_EQ(shadows->times_made(), made += anew) << what;
  };
  set(true, "first");
  EXPECT_EQ(shadows->maps(), 80);
  set(false, "the same");
  positions->on_s_mm[0] = Vec2(1, 2);
  set(false, "positions that do not count");
  settings.weighing = ShadowWeighing::mean;
  settings.depth_bias = 1e-3;
  lamp.channels = {"R", "G", "B"};
  set(false, "what the maps do not depend on");
  pose(0, 3) = 1;
  set(true, "pose");
  lamp.planes.separation_mm = 140;
  set(true, "planes");
  settings.map_px = 64;
  set(true, "size");
  settings.tiles_per_map = 2;
  set(true, "sharing");
  EXPECT_EQ(shadows->maps(), 20);
  settings.position = ShadowPosition::published;
  set(true, "kind");
  set(false, "the same published ones");
  positions->on_s_mm[0] = Vec2(3, 2);
  set(true, "positions");

  EXPECT_FALSE(shadows->set(pose, lamp, settings, std::nullopt));
  EXPECT_FALSE(shadows->see({}, {})) << "after an error there are none";
  set(true, "again");
}

TEST_F(TileShadowsTest, OfPublishedMapsThoseAreDrawnWhosePositionIsAnother) {
  std::vector<TestTriangle> triangles;
  add_quad(triangles, {-900, -900, 900}, {1800, 0, 0}, {0, 1800, 0});
  add_box(triangles, {-100, -100, 400}, {50, 100, 700});
  const Mesh mesh = mesh_of(triangles);
  const auto receivers = surface_receivers(mesh, Pose::Identity(), 500, 3);
  const ShadowSettings settings{.position = ShadowPosition::published, .map_px = 64};
  std::optional<TilePositions> positions = positions_on(bike);
  for (const std::size_t k : {4U, 5U, 40U, 79U}) positions->on_s_mm[k] = std::nullopt;
  const auto shadows = shadows_in(mesh);
  int drawn = 0;
  const auto set = [&](int more, const char* what) {
    ASSERT_TRUE(shadows->set(Pose::Identity(), bike, settings, positions));
    EXPECT_EQ(shadows->maps_drawn(), drawn += more) << what;
    const auto anew = shadows_in(mesh);
    ASSERT_TRUE(anew->set(Pose::Identity(), bike, settings, positions));
    EXPECT_EQ(see(*shadows, receivers).words, see(*anew, receivers).words) << what;
  };
  set(80 + 65, "80 tiles, 15 without a position");
  positions->on_s_mm[4] = Vec2(10, -5);
  positions->on_s_mm[79] = Vec2(-30, 8);
  set(2, "two get theirs");
  positions->on_s_mm[7] = Vec2(1, 12);
  positions->on_s_mm[8] = Vec2(2, 11);
  positions->on_s_mm[60] = std::nullopt;
  set(2, "two move, one goes");
  positions = positions_on(bike);
  set(7, "four move back, three come");
}

TEST_F(TileShadowsTest, SeveralLampsShareADeviceAndKeepTheirOwnMaps) {
  std::vector<TestTriangle> triangles;
  add_quad(triangles, {-900, -900, 900}, {1800, 0, 0}, {0, 1800, 0});
  add_box(triangles, {-100, -100, 400}, {50, 100, 700});
  const Mesh mesh = mesh_of(triangles);
  const auto receivers = surface_receivers(mesh, Pose::Identity(), 500, 3);
  Pose beside = Pose::Identity();
  beside(0, 3) = 30;
  auto first = shadows_in(mesh);
  ASSERT_TRUE(first->set(Pose::Identity(), bike, {}));
  const TileVisibility before = see(*first, receivers);
  const auto second = first->another();
  EXPECT_EQ(second->pose(), std::nullopt);
  EXPECT_FALSE(second->has(Pose::Identity(), bike, {}));
  EXPECT_FALSE(second->see({}, {})) << "no light yet";
  ASSERT_TRUE(second->set(beside, bike, {.map_px = 64}));
  EXPECT_EQ(second->pose(), beside);
  EXPECT_TRUE(second->has(beside, bike, {.map_px = 64}));
  EXPECT_FALSE(second->has(beside, bike, {}));
  EXPECT_FALSE(second->has(Pose::Identity(), bike, {.map_px = 64}));
  EXPECT_NE(see(*second, receivers).words, before.words);
  EXPECT_EQ(see(*first, receivers).words, before.words);
  EXPECT_EQ(first->times_made(), 1);
  first.reset();
  const auto alone = shadows_in(mesh);
  ASSERT_TRUE(alone->set(beside, bike, {.map_px = 64}));
  EXPECT_EQ(see(*second, receivers).words, see(*alone, receivers).words) << "the one it was made of is gone";
}

TEST_F(TileShadowsTest, RefusesListsThatDoNotFit) {
  auto shadows = shadows_in(mesh_of({{Vec3(-9, 0, 900), Vec3(9, 0, 900), Vec3(0, 9, 900)}}));
  LuminaireGeometry wide = bike;
  wide.sampling.columns = wide.sampling.rows = 2000;
  ASSERT_TRUE(shadows->set(Pose::Identity(), wide, {.map_px = 4, .tiles_per_map = 32}));
  std::vector<float> four(4, 1.0F), eight(8, 1.0F), seven(7, 1.0F), many(4 * 3000, 1.0F);
  EXPECT_THAT(shadows->see(four, eight).error().message(), HasSubstr("four of each"));
  EXPECT_THAT(shadows->see(seven, seven).error().message(), HasSubstr("four of each"));
  EXPECT_THAT(shadows->see(many, many).error().message(), HasSubstr("render in parts"));  // 2001 rows of 63 words each
  EXPECT_TRUE(shadows->see(four, four));
  EXPECT_TRUE(shadows->see({}, {})->empty());
  EXPECT_THAT(shadows->set(Pose::Identity(), wide, {}).error().message(), HasSubstr("more tiles per map"));
}

TEST_F(TileShadowsTest, StructsAreLaidOutAsOnTheHost) {
  const std::vector<int> layout = test::layout_by("tile_visibility", "tile_visibility_layout", 4);
  EXPECT_EQ(layout, (std::vector<int>{sizeof(ShadowTiles), sizeof(ShadowTileMap), offsetof(ShadowTiles, separation),
                                      offsetof(ShadowTileMap, first)}));
}

}  // namespace
}  // namespace lumifield
