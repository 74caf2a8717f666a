#include "renderer/visibility/tile_positions.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "renderer/visibility/shadow_plan.h"

namespace lumifield {
namespace {

using testing::HasSubstr;

LuminaireGeometry geometry_of(BasisKind basis, const std::vector<std::string>& channels = {"Y"}) {
  return {{150}, {basis, {7.5, 6}, 3, 2, {3, -2}}, {10, 8, {4, 5}, {30, -10}}, channels, Quantity::relative};
}

/// Dark but for some pixels.
CellImage image_of(const LuminaireGeometry& geometry, const std::vector<std::tuple<int, int, int, float>>& pixels) {
  CellImage image{geometry.measurement.width_px,
                  geometry.measurement.height_px,
                  static_cast<int>(geometry.channels.size()),
                  {},
                  {},
                  {}};
  image.value.assign(image.plane() * geometry.channels.size(), 0);
  for (const auto& [channel, i, j, value] : pixels) image.channel(channel)[j * image.width_px + i] = value;
  return image;
}

/// Of S, in pixels.
Vec2 mm(const LuminaireGeometry& geometry, double i, double j) {
  return geometry.measurement.corner_mm() + geometry.measurement.pixel_mm.cwiseProduct(Vec2(i, j));
}

TEST(TilePositions, MedianIsWhereBothCdfsAreAHalf) {
  const LuminaireGeometry geometry = geometry_of(BasisKind::bell, {"R", "G", "B"});
  // Columns weigh 1, 4 and 2 with signs that do not count: half of 7 is reached 2.5/4 into column 5, whose rows weigh 1
  // and 3: half of 4 is reached 1/3 into row 6.
  const CellImage image =
      image_of(geometry, {{0, 2, 7, -1}, {0, 5, 1, 0.5F}, {1, 5, 1, -0.5F}, {2, 5, 6, 3}, {1, 9, 0, -2}});
  const auto median = median_mm(geometry.measurement, image);
  ASSERT_TRUE(median);
  EXPECT_LT((*median - mm(geometry, 5 + 2.5 / 4, 6 + 1.0 / 3)).norm(), 1e-9) << median->transpose();
  EXPECT_FALSE(median_mm(geometry.measurement, image_of(geometry, {})));
}

TEST(TilePositions, ATileHasTheMeanOfItsLitCellsMedians) {
  for (const auto& [basis, n] : {std::pair(BasisKind::box, 1), {BasisKind::bell, 2}, {BasisKind::bspline2, 3}}) {
    LightField field(geometry_of(basis));
    const auto add = [&](CellIndex cell, int i, int j, float value) {
      ASSERT_TRUE(field.add(cell, image_of(field.geometry(), {{0, i, j, value}})));
    };
    add({0, 0}, 2, 3, 5);
    add({0, 1}, 6, 1, -0.01F);
    add({1, 1}, 9, 7, 0);  // dark
    const TilePositions positions = published_positions(field);
    EXPECT_EQ(positions.grid, TileGrid(field.geometry().sampling));
    for (int row = 0; row < positions.grid.rows; ++row)
      for (int column = 0; column < positions.grid.columns; ++column) {
        const bool first = row < n && column < n, second = row < n && column >= 1 && column < 1 + n;
        const auto& at = positions.at(column, row);
        ASSERT_EQ(at.has_value(), first || second) << column << ", " << row;
        if (!at) continue;
        const Vec2 expected = first && second ? mm(field.geometry(), 4.5, 2.5)
                              : first         ? mm(field.geometry(), 2.5, 3.5)
                                              : mm(field.geometry(), 6.5, 1.5);
        EXPECT_LT((*at - expected).norm(), 1e-9) << column << ", " << row;
      }
  }
}

TEST(TilePositions, FirstOnesStayAndNewTilesJoin) {
  const LuminaireGeometry geometry = geometry_of(BasisKind::bell);
  LightField field(geometry);
  FirstPositions first(geometry);
  const auto take = [&] {
    first.take(images_by_cell(field));
    return first.positions();
  };
  const auto add = [&](CellIndex cell, int i, int j, float value = 1) {
    const auto image = std::make_shared<const CellImage>(image_of(geometry, {{0, i, j, value}}));
    const bool gives = first.would_give(cell, image);
    EXPECT_TRUE(field.add(cell, image));
    return gives;
  };
  EXPECT_TRUE(add({0, 0}, 2, 3));
  const TilePositions before = take();
  EXPECT_EQ(before, published_positions(field));
  EXPECT_TRUE(add({0, 1}, 6, 1));
  const TilePositions both = published_positions(field);
  EXPECT_NE(before.at(1, 0), both.at(1, 0)) << "the mean moves";
  const TilePositions now = take();
  EXPECT_EQ(now.at(0, 0), before.at(0, 0));
  EXPECT_EQ(now.at(1, 0), before.at(1, 0));
  EXPECT_EQ(now.at(2, 0), both.at(2, 0));
  EXPECT_FALSE(now.at(3, 0));

  // Dark ones, and those all of whose tiles have one, give none. What is lit when it is taken again does.
  EXPECT_FALSE(add({1, 2}, 5, 5, 0));
  EXPECT_FALSE(add({0, 0}, 9, 7));
  EXPECT_EQ(take(), now);
  EXPECT_TRUE(add({1, 2}, 5, 5));
  EXPECT_EQ(take().at(3, 2), mm(geometry, 5.5, 5.5));
}

TEST(TilePositions, AMedianIsComputedOnceAndOnlyWhereATileHasNone) {
  const LuminaireGeometry geometry = geometry_of(BasisKind::bell);
  LightField field(geometry);
  for (int k = 0; k < 5; ++k)  // all but the last, {1, 2}; {0, 2} is dark
    ASSERT_TRUE(field.add(geometry.sampling.index(k), image_of(geometry, {{0, k, 3, k == 2 ? 0.0F : 1.0F}})));
  FirstPositions first(geometry);
  first.take(images_by_cell(field));
  EXPECT_EQ(first.medians_computed(), 5);
  first.take(images_by_cell(field));
  EXPECT_EQ(first.medians_computed(), 5);
  const auto last = std::make_shared<const CellImage>(image_of(geometry, {{0, 1, 1, 1}}));
  EXPECT_TRUE(first.would_give({1, 2}, last));
  ASSERT_TRUE(field.add({1, 2}, last));
  first.take(images_by_cell(field));
  EXPECT_EQ(first.medians_computed(), 6);
  // A retake of a cell whose tiles have theirs.
  EXPECT_FALSE(first.would_give({0, 0}, last));
  EXPECT_EQ(first.medians_computed(), 6);
}

TEST(ShadowPlan, CentresShowTheImageAndHalfATile) {
  const LuminaireGeometry geometry = geometry_of(BasisKind::bell);
  const auto plan = plan_shadows(geometry, {}, std::nullopt);
  ASSERT_TRUE(plan);
  ASSERT_EQ(plan->views.size(), 12U);
  EXPECT_TRUE(plan->maps_of[1].empty());
  std::vector<Vec2> parts;
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 4; ++column) {
      const ShadowView& view = plan->views[static_cast<std::size_t>(plan->maps_of[0][row * 4 + column])];
      const Vec2 e = plan->grid.center_mm(column, row);
      EXPECT_EQ(view.eye_mm, Vec3(e.x(), e.y(), 0));
      // On S: the image [10, 50] × [−30, 10], widened, and one texel more, of which a part lies on either side.
      const Vec2 texel = 150 * (view.high - view.low) / ShadowSettings{}.map_px;
      const Vec2 below = Vec2(10 - 3.75, -30 - 3) - (e + 150 * view.low),
                 above = e + 150 * view.high - Vec2(50 + 3.75, 10 + 3);
      EXPECT_LT((below + above - texel).norm(), 1e-12);
      EXPECT_GE(std::min(below.minCoeff(), above.minCoeff()), -1e-12);
      parts.emplace_back(below.x() / texel.x(), below.y() / texel.y());
    }
  // No two maps' texels lie alike.
  for (std::size_t k = 0; k < parts.size(); ++k)
    for (std::size_t i = 0; i < k; ++i) EXPECT_GT((parts[k] - parts[i]).norm(), 0.05);
}

TEST(ShadowPlan, TilesShareMaps) {
  const LuminaireGeometry geometry = geometry_of(BasisKind::bspline2);  // 5×4 tiles
  const auto plan = plan_shadows(geometry, {.tiles_per_map = 3}, std::nullopt);
  ASSERT_TRUE(plan);
  EXPECT_EQ(plan->columns, 2);
  EXPECT_EQ(plan->rows, 2);
  EXPECT_EQ(plan->maps_of[0], (std::vector{0, 1, 2, 3}));
  const Vec2 middle = plan->grid.center_mm(1, 1), rest = (plan->grid.center_mm(3, 3) + plan->grid.center_mm(4, 3)) / 2;
  EXPECT_LT((plan->views[0].eye_mm - Vec3(middle.x(), middle.y(), 0)).norm(), 1e-12);
  EXPECT_LT((plan->views[3].eye_mm - Vec3(rest.x(), rest.y(), 0)).norm(), 1e-12);
  const Vec2 texel = 150 * (plan->views[0].high - plan->views[0].low) / ShadowSettings{}.map_px;
  const Vec2 below = Vec2(10 - 1.5 * 7.5, -30 - 1.5 * 6) - (middle + 150 * plan->views[0].low);
  EXPECT_TRUE((below.array() >= 0).all() && (below.array() <= texel.array()).all());
}

TEST(ShadowPlan, PublishedOnesStandOnSWhereTheyAre) {
  LightField field(geometry_of(BasisKind::bell));
  ASSERT_TRUE(field.add({0, 0}, image_of(field.geometry(), {{0, 2, 3, 1}})));
  const auto plan = plan_shadows(field.geometry(), {.position = ShadowPosition::published}, published_positions(field));
  ASSERT_TRUE(plan);
  EXPECT_EQ(plan->maps_of[0].size(), 12U);
  EXPECT_EQ(plan->maps_of[1], (std::vector{12, 13, -1, -1, 14, 15, -1, -1, -1, -1, -1, -1}));
  const Vec2 at = mm(field.geometry(), 2.5, 3.5);
  for (std::size_t k = 12; k < 16; ++k) {
    EXPECT_LT((plan->views[k].eye_mm - Vec3(at.x(), at.y(), 150)).norm(), 1e-9);
    // Half image (20, 20), half grid (15, 9), centres (27, 8) apart.
    EXPECT_LT((plan->views[k].high - published_widening * Vec2(62, 37) / 150).norm(), 1e-12);
    EXPECT_EQ(plan->views[k].low, -plan->views[k].high);
  }
}

TEST(ShadowPlan, RefusesWhatHasNoSense) {
  const LuminaireGeometry geometry = geometry_of(BasisKind::bell);
  const auto refusal = [&](const ShadowSettings& settings, const std::optional<TilePositions>& positions = {}) {
    const auto plan = plan_shadows(geometry, settings, positions);
    return plan ? "planned" : plan.error().message();
  };
  EXPECT_EQ(refusal({}), "planned");
  EXPECT_THAT(refusal({.map_px = 0}), HasSubstr("0 texels"));
  EXPECT_THAT(refusal({.map_px = 1 << 30}), HasSubstr("more tiles per map"));
  EXPECT_THAT(refusal({.tiles_per_map = 0}), HasSubstr("ask for 1 to 32"));
  EXPECT_THAT(refusal({.tiles_per_map = 33}), HasSubstr("ask for 1 to 32"));
  EXPECT_THAT(refusal({.depth_bias = -1}), HasSubstr("bias"));
  EXPECT_THAT(refusal({.depth_bias = NAN}), HasSubstr("bias"));
  EXPECT_THAT(refusal({.position = ShadowPosition::published}), HasSubstr("not there"));
  EXPECT_THAT(
      refusal({.position = ShadowPosition::published}, published_positions(LightField(geometry_of(BasisKind::tent)))),
      "planned");
  EXPECT_THAT(
      refusal({.position = ShadowPosition::published}, published_positions(LightField(geometry_of(BasisKind::box)))),
      HasSubstr("another luminaire"));
  EXPECT_FALSE(plan_shadows({}, {}, std::nullopt));
}

}  // namespace
}  // namespace lumifield
