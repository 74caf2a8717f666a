// Pictures with shadows, as cells, placements and visibilities change.
#include <gmock/gmock.h>

#include "tests/support/renderer_fixture.h"

namespace lumifield {
namespace {

using test::difference;
using test::geometry_of;
using test::height;
using test::image_of;
using test::light_field_of;
using test::width;
using testing::HasSubstr;

using RendererShadows = test::RendererTest;

/// Rays and maps darken the same places; placements that are moved look as if they had always stood there, whatever
/// stood there before.
TEST_F(RendererShadows, WhatStandsBeforeALuminaireCastsAShadow) {
  const Scene pillars = read_scene(LUMIFIELD_SOURCE_DIR "/resources/scenes/pillars/scene.json").value();
  const LightField field = light_field_of(geometry_of({"Y"}));
  auto renderer = renderer_of(pillars, field.geometry());
  ASSERT_TRUE(renderer->add_all(field));
  EXPECT_EQ(renderer->visibility(), Visibility::tile);
  const Picture shadowed = *renderer->picture();
  EXPECT_EQ(renderer->shadow_maps_made(), 1);
  ASSERT_TRUE(renderer->set_visibility(Visibility::none));
  const Picture bare = *renderer->picture();
  EXPECT_THAT(bare.note, HasSubstr("shadows"));
  EXPECT_EQ(renderer->info().left_out, bare.note);
  EXPECT_NE(renderer->info().left_out, shadowed.note) << "that was another visibility";
  ASSERT_TRUE(renderer->set_visibility(Visibility::rays));
  const Picture by_rays = *renderer->picture();
  int darker = 0;
  for (std::size_t i = 0; i < bare.rgb.size(); ++i) {
    EXPECT_LE(by_rays.rgb[i], bare.rgb[i] * (1 + 1e-5F));
    EXPECT_LE(shadowed.rgb[i], bare.rgb[i] * (1 + 1e-5F));
    darker += by_rays.rgb[i] < 0.9F * bare.rgb[i];
  }
  EXPECT_GT(darker, 30);
  EXPECT_LT(difference(by_rays, shadowed), 0.5 * difference(by_rays, bare));

  // Back to maps: those of before.
  ASSERT_TRUE(renderer->set_visibility(Visibility::tile));
  EXPECT_EQ(difference(shadowed, *renderer->picture()), 0);
  EXPECT_EQ(renderer->shadow_maps_made(), 1);

  // Moved.
  Scene moved = pillars;
  moved.luminaires[0].pose(1, 3) += 150;
  ASSERT_TRUE(renderer->set_placements(moved.luminaires));
  const Picture after = *renderer->picture();
  EXPECT_EQ(renderer->shadow_maps_made(), 2);
  EXPECT_GT(difference(shadowed, after), 0.01);
  EXPECT_LT(difference(fresh(moved, field), after), 1e-12);
}

TEST_F(RendererShadows, PublishedShadowsStayWhereTheFirstCellsPutThemUntilRefreshed) {
  Scene pillars = read_scene(LUMIFIELD_SOURCE_DIR "/resources/scenes/pillars/scene.json").value();
  const LightField field = light_field_of(geometry_of({"Y"}));
  LightField other = light_field_of(geometry_of({"Y"}));
  auto renderer = renderer_of(pillars, field.geometry());
  ASSERT_TRUE(renderer->set_visibility(Visibility::published));
  ASSERT_TRUE(renderer->add_all(field));
  (void)*renderer->picture();
  EXPECT_EQ(renderer->shadow_maps_made(), 1);
  // A cell that is taken again, its light elsewhere.
  ASSERT_TRUE(renderer->add_cell({1, 2}, image_of(field.geometry(), 77)));
  (void)*renderer->picture();
  EXPECT_EQ(renderer->shadow_maps_made(), 1);
  renderer->refresh_shadows();
  const Picture refreshed = *renderer->picture();
  EXPECT_EQ(renderer->shadow_maps_made(), 2);
  ASSERT_TRUE(other.add({1, 2}, image_of(field.geometry(), 77)));
  auto anew = renderer_of(pillars, field.geometry());
  ASSERT_TRUE(anew->set_visibility(Visibility::published));
  ASSERT_TRUE(anew->add_all(other));
  EXPECT_LT(difference(*anew->picture(), refreshed), 1e-12);
}

/// Each cell but the first and the last, which are dark, gives tiles their first position.
TEST_F(RendererShadows, UnderPublishedShadowsACellThatComesCostsOne) {
  const Scene pillars = read_scene(LUMIFIELD_SOURCE_DIR "/resources/scenes/pillars/scene.json").value();
  const LuminaireGeometry geometry = geometry_of({"Y"});
  const auto dark = std::make_shared<const CellImage>(
      CellImage{40, 30, 1, std::vector<float>(geometry.measurement.pixels(), 0.0F), {}, {}});
  for (const double lod : {0.0, 1.0}) {
    auto renderer = renderer_of(pillars, geometry);
    ASSERT_TRUE(renderer->set_visibility(Visibility::published));
    ASSERT_TRUE(renderer->set_view(pillars.camera, width, height, lod));
    for (int k = 0; k < 6; ++k) {
      const CellIndex cell = geometry.sampling.index(k);
      const int made = renderer->shadow_maps_made();
      const bool gives = k != 0 && k != 5;
      ASSERT_TRUE(renderer->add_cell(cell, gives ? image_of(geometry, 60U + static_cast<unsigned>(k)) : dark));
      EXPECT_EQ(renderer->shadow_maps_made(), made + (gives || k == 0)) << k;
      if (lod > 0 && gives) {
        EXPECT_EQ(renderer->waiting(), k + 1) << "coarse maps are shared by tiles, so all cells wait, it with them";
        ASSERT_TRUE(renderer->picture());
      }
      EXPECT_EQ(renderer->waiting(), 0) << k;
      EXPECT_EQ(renderer->summed(), k + 1);
    }
    // One that is taken again, and one that waits: the picture of the others stands.
    ASSERT_TRUE(renderer->add_cell({0, 1}, image_of(geometry, 99)));
    EXPECT_EQ(renderer->waiting(), 0);
    const Picture before = *renderer->picture();
    ASSERT_TRUE(renderer->keep_cell({1, 2}, image_of(geometry, 98)));
    const Picture so_far = *renderer->picture_so_far();
    if (lod == 0) {
      EXPECT_LT(difference(before, so_far), 1e-12);
    }

    // As if all had come at once, with the positions that there are.
    const Picture come = *renderer->picture();
    EXPECT_GT(difference(before, come), 1e-3);
    ASSERT_TRUE(renderer->set_view(pillars.camera, width, height, lod));
    EXPECT_EQ(renderer->waiting(), 6);
    EXPECT_LT(difference(*renderer->picture(), come), 1e-6) << lod;
  }
}

}  // namespace
}  // namespace lumifield
