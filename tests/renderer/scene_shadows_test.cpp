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

/// Each cell has its light elsewhere; those of the last column are dark.
LightField lit_cells(const LuminaireGeometry& geometry) {
  LightField field(geometry);
  const Measurement& m = geometry.measurement;
  for (int k = 0; k < geometry.sampling.cells(); ++k) {
    CellImage image{m.width_px, m.height_px, 1, std::vector<float>(m.pixels(), 0.0F), {}, {}};
    const CellIndex cell = geometry.sampling.index(k);
    if (cell.column < geometry.sampling.columns - 1) image.value[(static_cast<std::size_t>(k) * 37) % m.pixels()] = 1;
    EXPECT_TRUE(field.add(cell, std::move(image)));
  }
  return field;
}

class SceneShadowsTest : public test::WithEgl {
 protected:
  void SetUp() override {
    WithEgl::SetUp();
    if (const auto cl = probe_opencl(); !cl) GTEST_SKIP() << cl.error().message();
  }
  /// What one lamp's receivers see by maps of its own.
  std::vector<std::uint32_t> alone(const ScenePlacement& lamp, const TestReceivers& receivers, ShadowSettings settings,
                                   const std::optional<TilePositions>& positions = {}) {
    if (!alone_) alone_ = TileShadows::create(*context_, mesh_).value();
    EXPECT_TRUE(alone_->set(lamp.pose, geometry_, settings, positions));
    return alone_->see(receivers.p_xyzw, receivers.face_xyzw).value().words;
  }
  std::vector<std::uint32_t> seen_by(SceneShadows& shadows, const std::vector<ScenePlacement>& placements,
                                     Visibility visibility, bool coarse, const Seen& seen) {
    Appearance appearance;
    const Status done =
        shadows.see(placements, geometry_, visibility, coarse, seen.all.p_xyzw, seen.all.face_xyzw, appearance);
    EXPECT_TRUE(done) << done.error().message();
    EXPECT_EQ(appearance.visible.weighing,
              visibility == Visibility::published ? ShadowWeighing::mean : ShadowWeighing::tile);
    return appearance.visible.words;
  }
  static void append(std::vector<std::uint32_t>& to, const std::vector<std::uint32_t>& words) {
    to.insert(to.end(), words.begin(), words.end());
  }

  const Mesh mesh_ = boxes();
  const LuminaireGeometry geometry_ = bell_grid();
  const ShadowSettings published_{.position = ShadowPosition::published, .weighing = ShadowWeighing::mean};
  const LightField cells_ = lit_cells(geometry_);
  const TilePositions positions_ = published_positions(cells_);
  std::unique_ptr<TileShadows> alone_;
};

TEST_F(SceneShadowsTest, EachLampsReceiversSeeAsWithItAlone) {
  const auto placements = lamps(3);
  const Seen seen(mesh_, placements, 700);
  SceneShadows shadows(*context_, mesh_);
  shadows.take_positions(geometry_, images_by_cell(cells_));
  std::vector<std::uint32_t> tile, published, rays;
  for (std::size_t k = 0; k < placements.size(); ++k) {
    append(tile, alone(placements[k], seen.of_lamp[k], {}));
    append(published, alone(placements[k], seen.of_lamp[k], published_, positions_));
    const TestReceivers& r = seen.of_lamp[k];
    const auto by = RayVisibility::create(mesh_, placements[k].pose).value();
    append(rays, by.see_tiles(TileGrid(geometry_.sampling), r.p_xyzw, r.face_xyzw).words);
  }
  EXPECT_NE(tile, published);
  EXPECT_NE(tile, rays);
  for (int round = 0; round < 2; ++round) {
    EXPECT_EQ(seen_by(shadows, placements, Visibility::tile, false, seen), tile);
    EXPECT_EQ(seen_by(shadows, placements, Visibility::published, false, seen), published);
    EXPECT_EQ(seen_by(shadows, placements, Visibility::rays, false, seen), rays);
  }

  // Of points, whoever asks, also when rays tell no more.
  Appearance appearance;
  ASSERT_TRUE(
      shadows.see(placements, geometry_, Visibility::rays, false, seen.all.p_xyzw, seen.all.face_xyzw, appearance));
  (void)seen_by(shadows, placements, Visibility::tile, false, seen);
  const auto one = RayVisibility::create(mesh_, placements[1].pose).value();
  int hidden = 0;
  for (std::size_t k = 0; k < 700; ++k) {
    const Vec2 u(9, -3);
    const bool sees = one.sees(seen.of_lamp[1].p(k), seen.of_lamp[1].n(k), {u.x(), u.y(), 0});
    EXPECT_EQ(appearance.sees(700 + k, u), sees) << k;
    hidden += !sees;
  }
  EXPECT_GT(hidden, 100);
  EXPECT_LT(hidden, 600);
}

TEST_F(SceneShadowsTest, MoreLampsThanKeepTheirMapsSeeAsWellAndAFewMakeThemAnew) {
  const std::size_t count = SceneShadows::most_kept + 2;
  const auto placements = lamps(count);
  const Seen seen(mesh_, placements, 60);
  SceneShadows shadows(*context_, mesh_);
  std::vector<std::uint32_t> expected;
  for (std::size_t k = 0; k < count; ++k) append(expected, alone(placements[k], seen.of_lamp[k], {}));
  EXPECT_EQ(seen_by(shadows, placements, Visibility::tile, false, seen), expected);
  EXPECT_EQ(shadows.times_made(), count);
  EXPECT_EQ(seen_by(shadows, placements, Visibility::tile, false, seen), expected);
  EXPECT_EQ(shadows.times_made(), count + 3) << "those that share one place";
  EXPECT_EQ(shadows.lamps_kept(), SceneShadows::most_kept);
}

TEST_F(SceneShadowsTest, CoarseMapsStandInUntilThereAreFineOnes) {
  auto placements = lamps(2);
  for (const Visibility visibility : {Visibility::tile, Visibility::published}) {
    ShadowSettings fine = visibility == Visibility::tile ? ShadowSettings{} : published_, coarse = fine;
    coarse.tiles_per_map = SceneShadows::coarse_tiles;
    coarse.map_px = SceneShadows::coarse_px;
    SceneShadows shadows(*context_, mesh_);
    shadows.take_positions(geometry_, images_by_cell(cells_));
    const auto expect = [&](bool asked_coarse, const std::array<ShadowSettings, 2>& settings, int made,
                            const char* what) {
      const Seen seen(mesh_, placements, 300);
      std::vector<std::uint32_t> expected;
      for (std::size_t k = 0; k < 2; ++k)
        append(expected, alone(placements[k], seen.of_lamp[k], settings[k], positions_));
      EXPECT_EQ(seen_by(shadows, placements, visibility, asked_coarse, seen), expected) << what;
      EXPECT_EQ(shadows.times_made(), made) << what;
    };
    expect(true, {coarse, coarse}, 2, "none there yet");
    expect(false, {fine, fine}, 4, "fine ones asked for");
    expect(true, {fine, fine}, 4, "fine ones there");
    placements[0].pose(1, 3) += 20;
    expect(true, {coarse, fine}, 5, "one has moved");
    expect(false, {fine, fine}, 6, "and rests");
  }
}

TEST_F(SceneShadowsTest, LampsThatGoLeaveTheOthersTheirMaps) {
  const auto all = lamps(4);
  SceneShadows shadows(*context_, mesh_);
  const auto see = [&](const std::vector<ScenePlacement>& placements) {
    const Seen seen(mesh_, placements, 100);
    std::vector<std::uint32_t> expected;
    for (std::size_t k = 0; k < placements.size(); ++k) append(expected, alone(placements[k], seen.of_lamp[k], {}));
    EXPECT_EQ(seen_by(shadows, placements, Visibility::tile, false, seen), expected);
    EXPECT_EQ(shadows.lamps_kept(), placements.size());
  };
  see(all);
  EXPECT_EQ(shadows.times_made(), 4);
  see({all[1], all[3]});
  see({all[3], all[1]});
  EXPECT_EQ(shadows.times_made(), 4) << "the others stand where they stood";
  see(all);
  EXPECT_EQ(shadows.times_made(), 6) << "those that came back";
  see({all[2], all[2]});
  EXPECT_EQ(shadows.times_made(), 7) << "of two at one place each has its own";
  Appearance appearance;
  ASSERT_TRUE(shadows.see({}, geometry_, Visibility::tile, false, {}, {}, appearance));
  EXPECT_EQ(shadows.lamps_kept(), 0U);
  EXPECT_EQ(shadows.times_made(), 7) << "a count of what has been does not fall";
}

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
