// Pictures by spotlights at the cells' centres, as cells come and change, with shadows, and without OpenCL.
#include <cmath>
#include <cstdlib>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "renderer/methods/device_method.h"
#include "renderer/methods/table_memory.h"
#include "renderer/renderer.h"
#include "renderer/shift_invariant/spot_memory.h"
#include "renderer/study/synthetic_luminaire.h"
#include "tests/support/apart.h"

namespace lumifield {
namespace {

using test::apart;
using testing::HasSubstr;

/// As on a machine that has none.
class WithoutOpenCl {
 public:
  WithoutOpenCl() { setenv("LUMIFIELD_OPENCL", "no such device", 1); }
  ~WithoutOpenCl() { unsetenv("LUMIFIELD_OPENCL"); }
};

constexpr MethodSettings spots{.method = Method::shift_invariant};

class RendererSpots : public testing::Test {
 protected:
  void SetUp() override {
    if (const auto gl = probe_opengl(); !gl) GTEST_SKIP() << gl.error().message();
    scene_ = read_scene(std::string(LUMIFIELD_SOURCE_DIR) + "/resources/scenes/corner/scene.json").value();
  }
  std::unique_ptr<Renderer> renderer(const MethodSettings& settings = spots,
                                     Visibility visibility = Visibility::tile) const {
    auto made = Renderer::create(scene_, 80, 60).value();
    EXPECT_TRUE(made->set_method(settings));
    EXPECT_TRUE(made->set_visibility(visibility));
    EXPECT_TRUE(made->set_luminaire(field_.geometry()));
    return made;
  }
  LightField field_ = make_luminaire({.name = "small", .columns = 3, .rows = 2, .pixels = 75, .pixel_mm = 4});
  Scene scene_;
};

TEST_F(RendererSpots, NeedNoOpenCl) {
  Picture with;
  if (probe_opencl()) {
    const auto there = renderer();
    ASSERT_TRUE(there->add_all(field_));
    with = there->picture().value();
  }
  const WithoutOpenCl none;
  const auto made = Renderer::create(scene_, 80, 60);
  ASSERT_TRUE(made) << made.error().message();
  EXPECT_TRUE((*made)->info().opencl.empty());
  EXPECT_THAT((*made)->info().notes, testing::Contains(HasSubstr("without OpenCL")));
  for (const MethodSettings& settings : {MethodSettings{}, {.method = Method::position_dependent}}) {
    const Status refused = (*made)->set_method(settings);
    ASSERT_FALSE(refused) << "before there is a luminaire";
    EXPECT_THAT(refused.error().remedy, HasSubstr("shift-invariant"));
  }
  EXPECT_FALSE((*made)->set_luminaire(field_.geometry())) << "by the closed form";
  ASSERT_TRUE((*made)->set_method(spots));
  ASSERT_TRUE((*made)->set_luminaire(field_.geometry()));
  ASSERT_TRUE((*made)->add_all(field_));
  const auto picture = (*made)->picture();
  ASSERT_TRUE(picture) << picture.error().message();
  EXPECT_GT((*made)->shadow_maps_made(), 0);
  EXPECT_FALSE((*made)->set_method({.method = Method::far_field}));
  EXPECT_EQ((*made)->picture().value().rgb, picture->rgb) << "what is refused leaves all as it was";
  if (!with.rgb.empty()) {
    EXPECT_EQ(picture->rgb, with.rgb);
  }
}

TEST_F(RendererSpots, GiveThePictureWithinTheirErrors) {
  if (const auto cl = probe_opencl(); !cl) GTEST_SKIP() << cl.error().message();
  const auto exact = renderer({}, Visibility::none), weighted = renderer(spots, Visibility::none);
  MethodSettings look_up = spots;
  look_up.spots.look_up = SpotLookUp::textured;
  const auto textured = renderer(look_up, Visibility::none);
  for (const auto& each : {&exact, &weighted, &textured}) ASSERT_TRUE((*each)->add_all(field_));
  const Picture wanted = exact->picture().value();
  EXPECT_LT(apart(weighted->picture().value(), wanted), 1e-3);
  EXPECT_LT(apart(textured->picture().value(), wanted), 0.05);

  // With shadows of their own: half-shadows have other edges, all else is alike.
  const auto shadowed = renderer(spots, Visibility::tile), by_tiles = renderer({}, Visibility::tile);
  ASSERT_TRUE(shadowed->add_all(field_));
  ASSERT_TRUE(by_tiles->add_all(field_));
  const Picture tiles = by_tiles->picture().value();
  EXPECT_LT(apart(shadowed->picture().value(), tiles), 0.1);
  EXPECT_GT(apart(wanted, tiles), 0.2) << "shadows matter here";
}

TEST_F(RendererSpots, ACellThatComesCostsOne) {
  const auto made = renderer();
  for (int k = 0; k < 6; ++k) {
    ASSERT_TRUE(made->keep_cell({k / 3, k % 3}, field_.cell({k / 3, k % 3})));
    EXPECT_EQ(made->waiting(), 1) << "those before stay summed";
    ASSERT_TRUE(made->picture());
    EXPECT_EQ(made->summed(), k + 1);
  }
  CellImage twice = *field_.cell({0, 1});
  for (float& v : twice.value) v *= 2;
  ASSERT_TRUE(field_.add({0, 1}, std::move(twice)));
  ASSERT_TRUE(made->add_cell({0, 1}, field_.cell({0, 1})));
  EXPECT_EQ(made->waiting(), 0);
  const auto fresh = renderer();
  ASSERT_TRUE(fresh->add_all(field_));
  EXPECT_LT(apart(made->picture().value(), fresh->picture().value()), 1e-6) << "what floats round";
}

TEST_F(RendererSpots, KeepTheirDepthMapsUntilTheLightMoves) {
  const auto made = renderer();
  ASSERT_TRUE(made->add_all(field_));
  const int maps = made->shadow_maps_made();
  EXPECT_GT(maps, 0);
  SceneCamera camera = scene_.camera;
  camera.target_mm.x() += 50;
  ASSERT_TRUE(made->set_view(camera, 100, 70));
  ASSERT_TRUE(made->picture());
  EXPECT_EQ(made->shadow_maps_made(), maps);
  std::vector<ScenePlacement> placements = scene_.luminaires;
  placements[0].pose(0, 3) += 5;
  ASSERT_TRUE(made->set_placements(placements));
  ASSERT_TRUE(made->picture());
  EXPECT_GT(made->shadow_maps_made(), maps);
}

TEST_F(RendererSpots, HowOftenMapsWereMadeIsACountThatDoesNotFall) {
  const auto made = renderer();
  std::vector<ScenePlacement> three(3, scene_.luminaires[0]);
  three[1].pose(0, 3) += 60;
  three[2].pose(0, 3) -= 60;
  ASSERT_TRUE(made->set_placements(three));
  ASSERT_TRUE(made->add_all(field_));
  const int first = made->shadow_maps_made();
  EXPECT_GE(first, 3);
  ASSERT_TRUE(made->set_placements({three[0]}));
  ASSERT_TRUE(made->picture());
  EXPECT_EQ(made->shadow_maps_made(), first) << "lamps are gone, what there was is not";
  ASSERT_TRUE(made->set_luminaire(field_.geometry()));
  EXPECT_EQ(made->shadow_maps_made(), first) << "another device";
  ASSERT_TRUE(made->add_all(field_));
  const int second = made->shadow_maps_made();
  EXPECT_GT(second, first);
  if (probe_opencl()) {
    ASSERT_TRUE(made->set_method({}));
    EXPECT_EQ(made->shadow_maps_made(), second) << "another method";
    ASSERT_TRUE(made->picture());
    EXPECT_EQ(made->shadow_maps_made(), second + 1);
  }
}

TEST_F(RendererSpots, EachPlacementHasItsOwnShadows) {
  std::vector<ScenePlacement> two = {scene_.luminaires[0], scene_.luminaires[0]};
  two[1].pose(0, 3) += 150;
  two[1].scale = 0.5;
  const auto picture_of = [&](const std::vector<ScenePlacement>& placements) {
    const auto made = renderer();
    EXPECT_TRUE(made->set_placements(placements));
    EXPECT_TRUE(made->add_all(field_));
    return made->picture().value();
  };
  const Picture both = picture_of(two), first = picture_of({two[0]}), second = picture_of({two[1]});
  Picture sum = first;
  for (std::size_t k = 0; k < sum.rgb.size(); ++k) sum.rgb[k] += second.rgb[k];
  EXPECT_LT(apart(both, sum), 1e-6);
}

TEST_F(RendererSpots, MapsOfMoreLuminairesThanThereIsMemoryForAreRefusedBeforeAnyIsMade) {
  MethodSettings settings = spots;
  settings.spots.shadow_map_px = 4096;
  const double maps = spot_memory(field_.geometry(), settings.spots, true, false).maps;
  const auto made = renderer(settings);
  const std::vector<ScenePlacement> many(static_cast<std::size_t>(host_memory_bytes() / 2 / maps) + 1,
                                         scene_.luminaires[0]);
  ASSERT_TRUE(made->set_placements(many));
  const Status refused = made->hand_over();
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().where, "receivers");
  EXPECT_THAT(refused.error().what, HasSubstr(std::to_string(many.size()) + " luminaires take"));
  ASSERT_TRUE(made->set_visibility(Visibility::none));
  EXPECT_TRUE(made->hand_over()) << "without shadows there are none";
  ASSERT_TRUE(made->set_visibility(Visibility::tile));
  ASSERT_TRUE(made->set_placements({scene_.luminaires[0]}));
  EXPECT_TRUE(made->hand_over());
  EXPECT_EQ(made->shadow_maps_made(), 0);
}

/// Each has a context of its own; which is current is nothing that the others rely on.
TEST_F(RendererSpots, SeveralContextsWorkOnOneThread) {
  const auto a = renderer(), b = renderer();
  const auto method = make_device_method(field_.geometry(), spots).value();
  const std::vector<Receiver> at = {{{3, -2, 240}, {0, 0, -1}}};
  ASSERT_TRUE(method->set_cells(field_));
  ASSERT_TRUE(a->add_all(field_));
  ASSERT_TRUE(method->set_receivers(at));
  ASSERT_TRUE(b->add_all(field_));
  ASSERT_TRUE(method->evaluate(HUGE_VAL).value());
  EXPECT_EQ(a->picture().value().rgb, b->picture().value().rgb);
  std::vector<double> e;
  ASSERT_TRUE(method->read(e));
  EXPECT_GT(e[0], 0);
  {
    const auto gone = make_device_method(field_.geometry(), spots).value();
    ASSERT_TRUE(gone->set_cells(field_));
  }
  ASSERT_TRUE(a->set_view(scene_.camera, 60, 40));
  EXPECT_TRUE(a->picture());
}

}  // namespace
}  // namespace lumifield
