// Depth maps of spotlights: the tests in the lighting pass against the same in double, and against rays.
#include <cmath>
#include <gtest/gtest.h>

#include "renderer/renderer.h"
#include "renderer/shift_invariant/shift_invariant_device.h"
#include "renderer/shift_invariant/spot_depths.h"
#include "renderer/visibility/ray_visibility.h"
#include "tests/support/meshes.h"

namespace lumifield {
namespace {

LuminaireGeometry lamp(int columns, int rows) {
  return {{150}, {BasisKind::bell, {7.5, 7.5}, columns, rows, {0, 0}}, {30, 30, {10, 10}, {0, 0}}, {"Y"}, {}};
}

std::shared_ptr<const CellImage> even_light(const LuminaireGeometry& g) {
  const Measurement& m = g.measurement;
  return std::make_shared<CellImage>(
      CellImage{m.width_px, m.height_px, 1, std::vector<float>(m.pixels(), 1.0F), {}, {}});
}

/// The depth test of one receiver in double, as spot_shaders.h has it.
double share_by(const ShadowMaps& maps, std::size_t number, int texels, const Vec3& p, const Vec3& face) {
  const ShadowView& view = maps.views[number];
  const Vec2 step = (view.high - view.low) / maps.size_px;
  const Vec3 q = p - view.eye_mm;
  const double kept = spot_depth_kept(view, maps.size_px), limit = q.z() * kept, own = face.dot(q) * kept;
  const Vec2 at = (q.head<2>() / q.z() - view.low).cwiseQuotient(step);
  if (at.minCoeff() < 0 || at.maxCoeff() > maps.size_px) return 1;
  const double side = std::max(texels - 1, 1);
  const Vec2 low = texels == 1 ? at : Vec2(at - Vec2(side, side) / 2);
  const Vec2 first = low.array().floor(), part = low - first;
  double hidden = 0;
  for (int j = 0; j < texels; ++j)
    for (int i = 0; i < texels; ++i) {
      const int x = static_cast<int>(first.x()) + i, y = static_cast<int>(first.y()) + j;
      const auto weight = [&](int k, double f) { return texels == 1 ? 1.0 : k == 0 ? 1 - f : k == texels - 1 ? f : 1; };
      const double depth =
          static_cast<double>(maps.depth_mm[number * maps.texels() +
                                            static_cast<std::size_t>(std::clamp(y, 0, maps.size_px - 1) * maps.size_px +
                                                                     std::clamp(x, 0, maps.size_px - 1))]);
      const Vec2 d = view.low + step.cwiseProduct(Vec2(x + 0.5, y + 0.5));
      const double across = face.dot(Vec3(d.x(), d.y(), 1));
      const bool before_face = depth * std::abs(across) < std::abs(own) || own * across <= 0;
      if (depth < limit && before_face) hidden += weight(i, part.x()) * weight(j, part.y());
    }
  return 1 - hidden / (side * side);
}

class SpotShadows : public testing::Test {
 protected:
  void SetUp() override {
    auto made = EglContext::create();
    if (!made) GTEST_SKIP() << made.error().message();
    context_ = std::move(*made);
  }
  /// What is seen of each cell, receiver-major: with shadows over without.
  std::vector<double> shares(const LuminaireGeometry& g, const Mesh& mesh, const Pose& pose, const TestReceivers& at,
                             const SpotSettings& settings) {
    const auto device = ShiftInvariantDevice::create(*context_, g, settings).value();
    EXPECT_TRUE(device->set_occluders(mesh));
    const auto image = even_light(g);
    std::vector<double> all(at.size() * static_cast<std::size_t>(g.sampling.cells()), -1.0);
    // Towards the lamp, so that none is dark for its normal.
    std::vector<float> n;
    for (std::size_t k = 0; k < at.size(); ++k)
      for (const double x : {0.0, 0.0, -1.0, 0.0}) n.push_back(static_cast<float>(x));
    for (int flat = 0; flat < g.sampling.cells(); ++flat) {
      std::vector<double> with, without;
      for (std::vector<double>* e : {&with, &without}) {
        EXPECT_TRUE(device->set_scene(
            {{pose}, e == &with ? std::span<const float>(at.face_xyzw) : std::span<const float>{}, 0}));
        EXPECT_TRUE(device->set_receivers(at.p_xyzw, n));
        EXPECT_TRUE(device->replace_cell(g.sampling.index(flat), image, nullptr));
        EXPECT_TRUE(device->read(*e));
      }
      for (std::size_t k = 0; k < at.size(); ++k)
        if (without[k] > 0)
          all[k * static_cast<std::size_t>(g.sampling.cells()) + static_cast<std::size_t>(flat)] = with[k] / without[k];
    }
    return all;
  }
  std::unique_ptr<EglContext> context_;
};

/// A room of boxes and a ball before the lamp, in its frame.
std::vector<TestTriangle> room() {
  std::vector<TestTriangle> triangles;
  add_quad(triangles, {-900, -900, 1200}, {1800, 0, 0}, {0, 1800, 300});
  add_box(triangles, {-200, -150, 500}, {-60, 120, 640});
  add_box(triangles, {120, -40, 700}, {220, 160, 900});
  add_sphere(triangles, {20, 60, 420}, 45, 12);
  return triangles;
}

TEST_F(SpotShadows, ThePassTestsDepthsAsInDouble) {
  const LuminaireGeometry g = lamp(3, 1);
  const Pose pose = tilted_pose();
  const Mesh mesh = mesh_of(room(), pose);
  const TestReceivers at = surface_receivers(mesh, pose, 4000, 3);
  std::vector<ShadowView> views;
  for (int k = 0; k < 3; ++k) views.push_back(spot_view(g, {0, k}, 64));
  const ShadowMaps maps = ShadowMapPass::create(*context_, mesh).value()->draw(pose, views, 64).value();
  for (const int texels : {1, 2, 3, 5}) {
    const auto seen =
        shares(g, mesh, pose, at, {.look_up = SpotLookUp::textured, .shadow_texels = texels, .shadow_map_px = 64});
    int told = 0, strays = 0, in_part = 0, hidden = 0;
    for (std::size_t k = 0; k < at.size(); ++k)
      for (std::size_t cell = 0; cell < 3; ++cell) {
        const double share = seen[3 * k + cell];
        if (share < 0) continue;
        ++told;
        strays += std::abs(share - share_by(maps, cell, texels, at.p(k), at.n(k))) > 1e-3;
        in_part += share > 0.01 && share < 0.99;
        hidden += share < 0.01;
      }
    EXPECT_GT(told, 3000);
    EXPECT_GT(hidden, 500);
    EXPECT_LE(strays, told / 500) << texels << " texels: rounding moves a test at a texel's edge or a grazing face";
    EXPECT_EQ(in_part > 0, texels > 1) << in_part;
  }
}

TEST_F(SpotShadows, AgreeWithRaysButNearShadowsEdges) {
  const LuminaireGeometry g = lamp(2, 2);
  const Pose pose = tilted_pose();
  const Mesh mesh = mesh_of(room(), pose);
  const TestReceivers at = surface_receivers(mesh, pose, 4000, 4);
  const auto seen = shares(g, mesh, pose, at, {.look_up = SpotLookUp::textured});
  const RayVisibility rays = RayVisibility::create(mesh, pose).value();
  int told = 0, others = 0;
  for (std::size_t k = 0; k < at.size(); ++k)
    for (int cell = 0; cell < 4; ++cell) {
      const double share = seen[4 * k + static_cast<std::size_t>(cell)];
      if (share < 0) continue;
      const Vec2 u = g.sampling.cell_center_mm(g.sampling.index(cell));
      ++told;
      others += std::abs(share - (rays.sees(at.p(k), at.n(k), {u.x(), u.y(), 0}) ? 1 : 0)) > 0.5;
    }
  EXPECT_GT(told, 4000);
  EXPECT_LT(others, told / 50) << others << " of " << told;
}

TEST_F(SpotShadows, ALitPlaneDoesNotShadowItself) {
  const LuminaireGeometry g = lamp(3, 1);
  const Pose pose = tilted_pose();
  std::mt19937 random(11);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (const double degrees : {0.0, 45.0, 70.0, 80.0, 85.0}) {
    const Eigen::AngleAxisd turn(degrees * std::numbers::pi / 180, Vec3(0.8, 0.6, 0));
    const Vec3 middle(0, 0, 1500), a = turn * Vec3(40000, 0, 0), b = turn * Vec3(0, 40000, 0), n = turn * Vec3(0, 0, 1);
    std::vector<TestTriangle> triangles;
    add_quad(triangles, middle - a / 2 - b / 2, a, b);
    TestReceivers at;
    while (at.size() < 2000) {
      const Vec3 d(unit(random), unit(random), 1);
      const double z = n.dot(middle) / n.dot(d);
      if (z > 200 && z < 12000 && std::abs(n.dot(d.normalized())) > std::cos(85.5 * std::numbers::pi / 180))
        at.add(z * d, unit(random) < 0 ? n : Vec3(-n));
    }
    for (const int texels : {1, 2, 4})
      for (const double share :
           shares(g, mesh_of(triangles, pose), pose, at, {.look_up = SpotLookUp::textured, .shadow_texels = texels}))
        if (share >= 0) {
          ASSERT_GT(share, 0.999) << degrees << "°, " << texels;
        }
  }
}

/// Granier et al. 2003, Sec. 4.1: with X = 3 lighting and depth passes are 4M/3.
TEST_F(SpotShadows, PassesAreAsManyAsCellsAndAThird) {
  const LuminaireGeometry g = lamp(9, 7);
  const Mesh mesh = mesh_of(room());
  const TestReceivers at = surface_receivers(mesh, Pose::Identity(), 100, 5);
  std::vector<CellIndex> cells;
  for (int k = 0; k < 63; ++k) cells.push_back(g.sampling.index(k));
  const std::vector<std::shared_ptr<const CellImage>> images(63, even_light(g));
  const auto device = ShiftInvariantDevice::create(*context_, g, {.cells_per_pass = 3, .shadow_map_px = 16}).value();
  ASSERT_FALSE(device->set_scene({{Pose::Identity()}, at.face_xyzw, 0})) << "nothing casts shadows";
  ASSERT_TRUE(device->set_occluders(mesh));
  const auto light_from = [&](const Pose& pose) {
    ASSERT_TRUE(device->set_scene({{pose}, at.face_xyzw, 0}));
    ASSERT_TRUE(device->set_receivers(at.p_xyzw, at.face_xyzw));
    ASSERT_TRUE(device->add_cells(cells, images));
  };
  light_from(Pose::Identity());
  EXPECT_EQ(device->depth_passes() + device->lighting_passes(), 4 * 63 / 3);
  light_from(Pose::Identity());
  EXPECT_EQ(device->depth_passes(), 0) << "maps are kept";
  EXPECT_EQ(device->lighting_passes(), 21);
  Pose moved = Pose::Identity();
  moved(0, 3) = 1;
  light_from(moved);
  EXPECT_EQ(device->depth_passes(), 63) << "until the light moves";
  device->forget_maps();
  light_from(moved);
  EXPECT_EQ(device->depth_passes(), 63) << "or the scene";
}

}  // namespace
}  // namespace lumifield
