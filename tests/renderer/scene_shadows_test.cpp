#include "renderer/visibility/scene_shadows.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "renderer/renderer.h"
#include "tests/support/egl_fixture.h"
#include "tests/support/meshes.h"

namespace lumifield {
namespace {

using testing::AllOf;
using testing::HasSubstr;

LuminaireGeometry bell_grid() {
  return {{150}, {BasisKind::bell, {7.5, 6}, 6, 4, {3, -2}}, {20, 16, {8, 9}, {10, -5}}, {"Y"}, Quantity::relative};
}

/// A floor 900 mm before the lamps with boxes on it.
Mesh boxes() {
  std::vector<TestTriangle> triangles;
  add_quad(triangles, {-900, -900, 900}, {1800, 0, 0}, {0, 1800, 0});
  for (const double x : {-300.0, -60.0, 180.0}) add_box(triangles, {x, -200, 500}, {x + 90, 120, 900});
  return mesh_of(triangles);
}

/// Lamps side by side, turned a little from each other.
std::vector<ScenePlacement> lamps(std::size_t count) {
  std::vector<ScenePlacement> placements(count);
  for (std::size_t k = 0; k < count; ++k) {
    const auto t = static_cast<double>(k);
    placements[k].pose.topLeftCorner<3, 3>() =
        Eigen::AngleAxisd(0.1 * t, Vec3(0.3, 1, 0.2).normalized()).toRotationMatrix();
    placements[k].pose.topRightCorner<3, 1>() = Vec3(-30 * t, 12 * t, 3 * t);
  }
  return placements;
}

/// The same surfaces as each lamp's receivers, one lamp after the other.
struct Seen {
  std::vector<TestReceivers> of_lamp;
  TestReceivers all;

  Seen(const Mesh& mesh, const std::vector<ScenePlacement>& placements, std::size_t each) {
    for (const ScenePlacement& placement : placements) {
      of_lamp.push_back(surface_receivers(mesh, placement.pose, each, 5));
      const TestReceivers& one = of_lamp.back();
      all.p_xyzw.insert(all.p_xyzw.end(), one.p_xyzw.begin(), one.p_xyzw.end());
      all.face_xyzw.insert(all.face_xyzw.end(), one.face_xyzw.begin(), one.face_xyzw.end());
    }
  }
};

class SceneShadowsTest : public test::WithEgl {
 protected:
  void SetUp() override {
    WithEgl::SetUp();
    if (const auto cl = probe_opencl(); !cl) GTEST_SKIP() << cl.error().message();
  }
  const Mesh mesh_ = boxes();
  const LuminaireGeometry geometry_ = bell_grid();
};

TEST_F(SceneShadowsTest, WhatAllLampsReceiversTakeIsBoundedTogether) {
  const auto placements = lamps(3);
  const Seen seen(mesh_, placements, 100);
  // 7×5 tiles: 5 words a receiver. Two lamps' fit into half of this, three do not.
  SceneShadows shadows(*context_, mesh_, 2 * 2.5 * 100 * 5 * 4);
  const auto see = [&](std::size_t count, Visibility visibility) {
    Appearance appearance;
    const auto part = [&](const std::vector<float>& list) { return std::span(list).first(count * 100 * 4); };
    const Status done = shadows.see({placements.begin(), placements.begin() + static_cast<long>(count)}, geometry_,
                                    visibility, false, part(seen.all.p_xyzw), part(seen.all.face_xyzw), appearance);
    return done ? std::to_string(appearance.visible.words.size()) : done.error().message();
  };
  EXPECT_THAT(see(3, Visibility::tile), AllOf(HasSubstr("shadows: 100 pixels seen by 3 luminaires take 6e-06 GB"),
                                              HasSubstr("smaller picture, or place fewer")));
  EXPECT_EQ(shadows.times_made(), 0) << "refused before anything is made";
  EXPECT_EQ(see(2, Visibility::tile), "1000");
  EXPECT_THAT(see(2, Visibility::rays), HasSubstr("2 luminaires")) << "rays keep the receivers as well";
  EXPECT_EQ(see(3, Visibility::none), "0");
}

}  // namespace
}  // namespace lumifield
