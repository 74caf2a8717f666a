#include <algorithm>
#include <gtest/gtest.h>

#include "luminaire/scene.h"
#include "renderer/renderer.h"
#include "renderer/visibility/ray_visibility.h"
#include "renderer/visibility/tile_shadows.h"
#include "tests/support/egl_fixture.h"
#include "tests/support/meshes.h"

namespace lumifield {
namespace {

LuminaireGeometry lamp_of(int columns, int rows, BasisKind basis) {
  return {{150}, {basis, {7.5, 7.5}, columns, rows, {2, -3}}, {300, 280, {1, 1}, {5, 0}}, {"Y"}, Quantity::relative};
}

/// The test of a receiver as TileShadows describes it, in double, and how near it was to another outcome.
struct Outcome {
  bool seen = true;
  double from_edge_px = 1;  ///< of the texel
  double from_equal = 1;    ///< of depth and plane, of the distance
};

Outcome outcome(const ShadowView& view, const float* depths, int size_px, double bias, const Vec3& p, const Vec3& n) {
  const Vec3 q = p - view.eye_mm;
  const Vec2 step = (view.high - view.low) / size_px;
  const Vec2 at = (q.head<2>() / q.z() - view.low).cwiseQuotient(step);
  Outcome out;
  for (int i = 0; i < 2; ++i) out.from_edge_px = std::min(out.from_edge_px, std::abs(at[i] - std::round(at[i])));
  if (at.minCoeff() < 0 || at.maxCoeff() >= size_px) return out;
  const int i = static_cast<int>(at.x()), j = static_cast<int>(at.y());
  const Vec2 center = view.low + step.cwiseProduct(Vec2(i + 0.5, j + 0.5));
  const double depth = static_cast<double>(depths[j * size_px + i]);
  const double own = n.dot(q), across = n.dot(Vec3(center.x(), center.y(), 1));
  const double plane = own / across;
  const double limit = plane > 0 && std::isfinite(plane) ? std::min(plane, q.z()) : q.z();
  out.seen = !(depth < limit * (1 - bias));
  const double reach = q.norm();
  if (std::isinf(depth)) return out;
  out.from_equal = std::min({std::abs(depth - q.z() * (1 - bias)) / reach, std::abs(across), std::abs(own) / reach,
                             std::abs(depth * std::abs(across) - std::abs(own) * (1 - bias)) / reach});
  return out;
}

class TileShadowsReferenceTest : public test::WithEgl {
 protected:
  void SetUp() override {
    WithEgl::SetUp();
    if (IsSkipped()) return;
    if (const auto opencl = probe_opencl(); !opencl) GTEST_SKIP() << opencl.error().message();
    scene_ = read_scene(LUMIFIELD_SOURCE_DIR "/resources/scenes/pillars/scene.json").value();
    mesh_ = read_mesh(scene_.mesh, scene_.materials).value();
    pose_ = scene_.luminaires[0].pose;
  }
  Scene scene_;
  Mesh mesh_;
  Pose pose_;
};

TEST_F(TileShadowsReferenceTest, TheKernelDecidesAsDoublePrecisionDoes) {
  auto shadows = TileShadows::create(*context_, mesh_).value();
  auto pass = ShadowMapPass::create(*context_, mesh_).value();
  TestReceivers receivers = surface_receivers(mesh_, pose_, 4000, 17);
  std::mt19937 random(23);
  std::normal_distribution<double> normal(0, 1);
  for (int k = 0; k < 1003; ++k)  // in the air, also between the planes and beside the lamp
    receivers.add(Vec3(150 * normal(random), 150 * normal(random), 120 + 150 * normal(random)),
                  Vec3(normal(random), normal(random), normal(random)).normalized());
  receivers.add({0, 0, 500}, {0, 0, 0});

  struct Case {
    LuminaireGeometry lamp;
    ShadowSettings settings;
  };
  for (const auto& [lamp, settings] :
       {Case{lamp_of(9, 7, BasisKind::bell), {}}, Case{lamp_of(9, 7, BasisKind::bspline2), {.tiles_per_map = 3}},
        Case{lamp_of(9, 7, BasisKind::bell), {.position = ShadowPosition::published}},
        Case{lamp_of(44, 3, BasisKind::tent),
             {.position = ShadowPosition::published, .map_px = 100, .tiles_per_map = 5, .depth_bias = 1e-3}}}) {
    TilePositions positions{TileGrid(lamp.sampling), {}};
    for (int k = 0; k < positions.grid.tiles(); ++k)
      positions.on_s_mm.push_back(k % 45 == 3 ? std::nullopt : std::optional(Vec2(k % 13 * 9.0 - 50, k % 5 * 11.0)));
    ASSERT_TRUE(shadows->set(pose_, lamp, settings, positions));
    const TileVisibility visible = shadows->see(receivers.p_xyzw, receivers.face_xyzw).value();
    const ShadowPlan plan = plan_shadows(lamp, settings, positions).value();
    const ShadowMaps maps = pass->draw(pose_, plan.views, settings.map_px).value();

    int tests = 0, differ = 0, hidden = 0;
    for (std::size_t k = 0; k < receivers.size(); ++k)
      for (int row = 0; row < plan.grid.rows; ++row)
        for (int column = 0; column < plan.grid.columns; ++column) {
          const Vec3 p = receivers.p(k), n = receivers.n(k);
          const bool beyond = settings.position == ShadowPosition::published && p.z() > 150;
          const int block = row / plan.block * plan.columns + column / plan.block;
          const int view = plan.maps_of[beyond ? 1 : 0][static_cast<std::size_t>(block)];
          Outcome expected;
          if (p.z() <= 0 || n == Vec3(0, 0, 0))
            expected.seen = false;
          else if (view >= 0)
            expected = outcome(plan.views[static_cast<std::size_t>(view)],
                               maps.depth_mm.data() + static_cast<std::size_t>(view) * maps.texels(), settings.map_px,
                               bias_of(plan.views[static_cast<std::size_t>(view)], settings), p, n);
          ++tests;
          hidden += !expected.seen;
          if (visible.sees(k, column, row) == expected.seen) continue;
          ++differ;
          // Float keeps a place on the map to some 4·2^-24 of its size, and what is compared to that of the distance.
          // What is near a map's own edge, steeply seen, is off by more.
          EXPECT_TRUE(expected.from_edge_px < 1e-6 * settings.map_px || expected.from_equal < 1e-6)
              << "receiver " << k << " at " << p.transpose() << ", tile " << column << ", " << row << ": "
              << expected.from_edge_px << " px, " << expected.from_equal;
        }
    EXPECT_GT(hidden, tests / 20);
    // 2·2e-4 texels of both axes are in doubt, and few neighbours decide otherwise.
    EXPECT_LE(differ, tests / 2500);
  }
}

TEST_F(TileShadowsReferenceTest, MapsDifferFromRaysOnlyWhereAShadowsEdgeIsWithinATexel) {
  const LuminaireGeometry lamp = lamp_of(9, 7, BasisKind::bell);
  const RayVisibility rays = RayVisibility::create(mesh_, pose_).value();
  auto shadows = TileShadows::create(*context_, mesh_).value();
  ASSERT_TRUE(shadows->set(pose_, lamp, {}));
  const TestReceivers receivers = surface_receivers(mesh_, pose_, 20000, 29);
  const TileVisibility by_maps = shadows->see(receivers.p_xyzw, receivers.face_xyzw).value();
  const TileVisibility by_rays = rays.see_tiles(TileGrid(lamp.sampling), receivers.p_xyzw, receivers.face_xyzw);
  const ShadowPlan plan = plan_shadows(lamp, {}, std::nullopt).value();

  int tests = 0, differ = 0, near_edges = 0, unexplained = 0, leaks = 0, hidden = 0;
  for (std::size_t k = 0; k < receivers.size(); ++k) {
    const Vec3 p = receivers.p(k), n = receivers.n(k);
    for (int row = 0; row < plan.grid.rows; ++row)
      for (int column = 0; column < plan.grid.columns; ++column) {
        const ShadowView& view = plan.views[static_cast<std::size_t>(row * plan.columns + column)];
        const Vec3 q = p - view.eye_mm;
        const Vec2 t = q.head<2>() / q.z(), step = (view.high - view.low) / 192;
        if (q.z() <= 0 || (t - view.low).minCoeff() < 0 || (view.high - t).minCoeff() <= 0) continue;
        ++tests;
        const bool seen = by_rays.sees(k, column, row);
        hidden += !seen;
        const bool differs = by_maps.sees(k, column, row) != seen;
        if (!differs && tests % 16 != 0) continue;
        // Rays from the face's plane, a texel around.
        int other = 0;
        for (int j = -2; j <= 2; ++j)
          for (int i = -2; i <= 2; ++i) {
            const Vec3 d(t.x() + i / 2.0 * step.x(), t.y() + j / 2.0 * step.y(), 1);
            const double z = n.dot(q) / n.dot(d);
            if (z > 0) other += rays.sees(view.eye_mm + z * d, n, view.eye_mm) != seen;
          }
        if (tests % 16 == 0) near_edges += 16 * (other > 0);
        if (!differs) continue;
        ++differ;
        leaks += !seen;
        unexplained += other == 0;
      }
  }
  RecordProperty("differ_percent", std::to_string(100.0 * differ / tests));
  RecordProperty("leak_percent", std::to_string(100.0 * leaks / tests));
  EXPECT_GT(tests, 200000);
  EXPECT_GT(hidden, tests / 20);
  // A test differs where an edge passes between the receiver and its texel's centre, a quarter of a texel across the
  // edge on average; it is near one that is a texel away on either side, two texels across at least. Twice that for
  // slanted edges and two at a time.
  EXPECT_LT(differ, near_edges / 4);
  // What is thinner than half a texel goes between the rays around.
  EXPECT_LE(unexplained, tests / 5000);
}

}  // namespace
}  // namespace lumifield
