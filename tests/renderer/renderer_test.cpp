#include "renderer/renderer.h"

#include <cmath>
#include <filesystem>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <limits>

#include "renderer/environment/environment_light.h"
#include "renderer/methods/table_memory.h"
#include "tests/support/exr_file.h"
#include "tests/support/renderer_fixture.h"

namespace lumifield {
namespace {

using test::difference;
using test::geometry_of;
using test::height;
using test::image_of;
using test::light_field_of;
using test::pose_of;
using test::RendererTest;
using test::width;
using testing::Contains;
using testing::HasSubstr;
using testing::Not;

TEST_F(RendererTest, EveryPixelIsTheClosedFormsAtItsPosition) {
  for (const auto& channels : {std::vector<std::string>{"Y"}, std::vector<std::string>{"R", "G", "B"}}) {
    LightField one(geometry_of(channels));
    ASSERT_TRUE(one.add({1, 2}, image_of(one.geometry(), 3)));
    const Picture picture = fresh(scene_, one);
    EXPECT_LT(difference(expected(one), picture), 1e-5);
    EXPECT_THAT(picture.coverage, Contains(0.0F)) << "the view has a background";
    for (std::size_t i = 0; i < picture.rgb.size(); ++i)
      EXPECT_TRUE(picture.coverage[i / 3] > 0 || picture.rgb[i] == 0);
    EXPECT_EQ(picture.note, "light from surface to surface");
  }
}

TEST_F(RendererTest, PlacementsAddUpWithTheirScales) {
  scene_.luminaires.push_back({pose_of(-2.2, {1, 0.1, 0.3}, {-300, -200, 650}), 2.5});
  const LightField field = light_field_of(geometry_of({"R", "G", "B"}));
  EXPECT_LT(difference(expected(field), fresh(scene_, field)), 1e-5);
}

TEST_F(RendererTest, TheOrderOfCellsDoesNotMatter) {
  const LightField field = light_field_of(geometry_of({"Y"}));
  auto renderer = renderer_of(scene_, field.geometry());
  for (int k = field.geometry().sampling.cells() - 1; k >= 0; --k) {
    const CellIndex cell = field.geometry().sampling.index(k);
    const Status added = renderer->add_cell(cell, field.cell(cell));
    ASSERT_TRUE(added) << added.error().message();
    EXPECT_GT(renderer->last_kernel_s(), 0);
  }
  EXPECT_LT(difference(fresh(scene_, field), *renderer->picture()), 1e-6);
}

TEST_F(RendererTest, AReplacedCellLooksAsIfItHadAlwaysBeenSo) {
  LightField field = light_field_of(geometry_of({"Y"}));
  auto renderer = renderer_of(scene_, field.geometry());
  ASSERT_TRUE(renderer->add_all(field));
  const Picture before = *renderer->picture();
  const auto retake = image_of(field.geometry(), 99);
  ASSERT_TRUE(field.add({0, 1}, retake));
  ASSERT_TRUE(renderer->add_cell({0, 1}, retake));
  const Picture after = *renderer->picture();
  EXPECT_GT(difference(before, after), 1e-3);
  EXPECT_LT(difference(fresh(scene_, field), after), 1e-6);
}

TEST_F(RendererTest, AChangedViewLooksLikeAFreshOne) {
  const LightField field = light_field_of(geometry_of({"Y"}));
  auto renderer = renderer_of(scene_, field.geometry());
  ASSERT_TRUE(renderer->add_all(field));
  scene_.camera.position_mm = {-500, -900, 700};
  ASSERT_TRUE(renderer->set_view(scene_.camera, width, height));
  EXPECT_EQ(difference(fresh(scene_, field), *renderer->picture()), 0);

  // A view that is refused leaves the picture as it was; another size is a view too.
  EXPECT_FALSE(renderer->set_view(scene_.camera, 0, height));
  EXPECT_EQ(difference(fresh(scene_, field), *renderer->picture()), 0);
  ASSERT_TRUE(renderer->set_view(scene_.camera, 17, 11));
  EXPECT_EQ(renderer->picture()->rgb.size(), 3U * 17 * 11);

  // Another luminaire starts from nothing.
  ASSERT_TRUE(renderer->set_luminaire(field.geometry()));
  const Picture nothing = *renderer->picture();
  EXPECT_THAT(nothing.rgb, testing::Each(0.0F));
}

TEST_F(RendererTest, ANewViewsCellsAreSummedInSlices) {
  const LightField field = light_field_of(geometry_of({"Y"}));
  auto renderer = renderer_of(scene_, field.geometry());
  EXPECT_EQ(renderer->waiting(), 0);
  ASSERT_TRUE(renderer->add_all(field));
  EXPECT_EQ(renderer->waiting(), 0);
  EXPECT_GT(renderer->cell_s(), 0);
  scene_.camera.position_mm = {-500, -900, 700};
  ASSERT_TRUE(renderer->set_view(scene_.camera, width, height));
  EXPECT_EQ(renderer->waiting(), 6);
  EXPECT_THAT(renderer->picture_so_far()->rgb, testing::Each(0.0F)) << "the sums are cleared";

  // A row of the grid when time is short; all when there is plenty.
  ASSERT_TRUE(renderer->sum_some(1e-9));
  ASSERT_EQ(renderer->waiting(), 3);
  ASSERT_EQ(renderer->summed(), 3);
  EXPECT_FALSE(renderer->waits({0, 2}));
  EXPECT_TRUE(renderer->waits({1, 0}));
  LightField first_row(field.geometry());
  for (int column = 0; column < 3; ++column) ASSERT_TRUE(first_row.add({0, column}, field.cell({0, column})));
  EXPECT_LT(difference(fresh(scene_, first_row), *renderer->picture_so_far()), 1e-6);
  ASSERT_TRUE(renderer->sum_some(1000));
  EXPECT_EQ(renderer->waiting(), 0);
  EXPECT_LT(difference(fresh(scene_, field), *renderer->picture()), 1e-6);

  // A view that is handed over by itself waits all the same, and one that comes then starts anew.
  ASSERT_TRUE(renderer->set_view(scene_.camera, width, height));
  ASSERT_TRUE(renderer->hand_over());
  ASSERT_TRUE(renderer->hand_over()) << "the second does nothing";
  EXPECT_EQ(renderer->waiting(), 6);
  EXPECT_THAT(renderer->picture_so_far()->rgb, testing::Each(0.0F));
  EXPECT_EQ(difference(fresh(scene_, field), *renderer->picture()), 0);
  ASSERT_TRUE(renderer->hand_over());
  EXPECT_EQ(renderer->waiting(), 0) << "the sums stay";

  // A view between two slices starts anew.
  ASSERT_TRUE(renderer->set_view(scene_.camera, width, height));
  ASSERT_TRUE(renderer->sum_some(1e-9));
  scene_.camera.position_mm = {300, -1200, 900};
  ASSERT_TRUE(renderer->set_view(scene_.camera, width, height));
  EXPECT_EQ(renderer->waiting(), 6);
  EXPECT_EQ(difference(fresh(scene_, field), *renderer->picture()), 0);
}

TEST_F(RendererTest, ALongRowIsSummedInSlicesToo) {
  LuminaireGeometry geometry = geometry_of({"Y"});
  geometry.sampling.columns = 40;
  geometry.sampling.rows = 1;
  const LightField field = light_field_of(geometry);
  auto renderer = renderer_of(scene_, geometry);
  for (int column = 0; column < 40; ++column) ASSERT_TRUE(renderer->keep_cell({0, column}, field.cell({0, column})));
  std::vector<int> summed;
  while (renderer->waiting() > 0) {
    ASSERT_TRUE(renderer->sum_some(1e-9));
    summed.push_back(renderer->summed());
  }
  EXPECT_EQ(summed, (std::vector<int>{16, 32, 40}));
  EXPECT_LT(difference(fresh(scene_, field), *renderer->picture()), 1e-6);
}

TEST_F(RendererTest, CellsThatComeWhileOthersWaitAreSummedWithThem) {
  LightField field = light_field_of(geometry_of({"Y"}));
  auto renderer = renderer_of(scene_, field.geometry());
  ASSERT_TRUE(renderer->add_all(field));

  // A replaced cell that waits stands as it was; what replaces it again while it waits is all that counts.
  const Picture before = *renderer->picture();
  ASSERT_TRUE(renderer->keep_cell({1, 1}, image_of(field.geometry(), 50)));
  EXPECT_EQ(renderer->waiting(), 1);
  EXPECT_EQ(difference(before, *renderer->picture_so_far()), 0);
  const auto retake = image_of(field.geometry(), 51);
  ASSERT_TRUE(renderer->add_cell({1, 1}, retake));
  EXPECT_EQ(renderer->waiting(), 1) << "another waits, so this does";
  ASSERT_TRUE(field.add({1, 1}, retake));
  EXPECT_LT(difference(fresh(scene_, field), *renderer->picture()), 1e-6);
  EXPECT_EQ(renderer->waiting(), 0);

  // New and replaced ones in one slice.
  auto other = renderer_of(scene_, field.geometry());
  for (int k = 0; k < 3; ++k)
    ASSERT_TRUE(other->add_cell(field.geometry().sampling.index(k), image_of(field.geometry(), 70)));
  for (int k = 0; k < 6; ++k) {
    const CellIndex cell = field.geometry().sampling.index(k);
    ASSERT_TRUE(other->keep_cell(cell, field.cell(cell)));
  }
  EXPECT_LT(difference(fresh(scene_, field), *other->picture()), 1e-6);

  EXPECT_FALSE(renderer->keep_cell({2, 0}, retake));
  EXPECT_FALSE(renderer->keep_cell({0, 0}, nullptr));
  EXPECT_FALSE(renderer->waits({2, 0}));
}

TEST_F(RendererTest, ALevelOfDetailIsPartOfTheView) {
  const LightField field = light_field_of(geometry_of({"Y"}));
  auto renderer = renderer_of(scene_, field.geometry());
  ASSERT_TRUE(renderer->add_all(field));
  const Picture exact = *renderer->picture();
  ASSERT_TRUE(renderer->set_view(scene_.camera, width, height, 1));
  const Picture coarse = *renderer->picture();
  EXPECT_LT(difference(expected(field, 1), coarse), 1e-5);
  EXPECT_GT(difference(exact, coarse), 1e-3);
  EXPECT_FALSE(renderer->set_view(scene_.camera, width, height, -1));
  EXPECT_FALSE(renderer->set_view(scene_.camera, width, height, std::nan("")));
  EXPECT_EQ(difference(coarse, *renderer->picture()), 0) << "a view that is refused changes nothing";
  ASSERT_TRUE(renderer->set_view(scene_.camera, width, height));
  EXPECT_EQ(difference(exact, *renderer->picture()), 0);
}

TEST_F(RendererTest, AnEnvironmentLightsTheSceneUnderAnyMethod) {
  support::ExrFile sky(64, 32);
  for (const char* name : {"R", "G", "B", "A"}) {
    sky.channels[name] = Imf::FLOAT;
    for (int k = 0; k < 64 * 32; ++k) sky.pixels[name].push_back(k < 64 * 16 ? 3.0F : 0.0F);
  }
  sky.write(folder_ / "sky.exr");
  const LightField field = light_field_of(geometry_of({"Y"}));
  const Picture without = fresh(scene_, field);
  EXPECT_FALSE(renderer_of(scene_, field.geometry())->set_environment(true)) << "there is none";
  EXPECT_FALSE(renderer_of(scene_, field.geometry())->info().has_environment);
  scene_.environment = folder_ / "sky.exr";
  scene_.environment_scale = 0.5;
  auto renderer = renderer_of(scene_, field.geometry());
  EXPECT_TRUE(renderer->environment());
  EXPECT_TRUE(renderer->info().has_environment);
  EXPECT_THAT(renderer->info().notes, Contains(HasSubstr("sky.exr: its alpha is not shown")));
  EXPECT_THAT(renderer->info().left_out, HasSubstr("what hides the environment"));
  ASSERT_TRUE(renderer->add_all(field));
  for (const Method method : {Method::closed_form, Method::uniform_box}) {
    ASSERT_TRUE(renderer->set_method({.method = method}));
    ASSERT_TRUE(renderer->set_environment(false));
    const Picture off = *renderer->picture();
    if (method == Method::closed_form) {
      EXPECT_EQ(difference(without, off), 0);
    }
    ASSERT_TRUE(renderer->set_environment(true));
    const Picture on = *renderer->picture();
    EXPECT_THAT(on.note, HasSubstr("environment"));
    EXPECT_EQ(renderer->waiting(), 0) << "the sums stay";
    // The floor looks up at a sky of 1.5: E = 1.5 π, of which Kd/π.
    int floors = 0;
    for (std::size_t k = 0; k < on.coverage.size(); ++k) {
      if (on.coverage[k] == 0) {
        EXPECT_EQ(on.rgb[3 * k], 0);
        continue;
      }
      const float added = on.rgb[3 * k + 2] - off.rgb[3 * k + 2];
      EXPECT_GT(added, 0.4F);
      if (std::abs(added - 0.75F * 1.5F) < 0.02F) ++floors;
    }
    EXPECT_GT(floors, 200);
  }
  // Another view has its own.
  SceneCamera from_above = scene_.camera;
  from_above.position_mm = {0, 90, 1500};
  from_above.up = {0, 1, 0};
  ASSERT_TRUE(renderer->set_view(from_above, width, height));
  EXPECT_TRUE(renderer->picture());
  std::stop_source end;
  end.request_stop();
  const auto stopped = Renderer::create(scene_, width, height, end.get_token());
  ASSERT_FALSE(stopped);
  EXPECT_EQ(stopped.error().kind, ErrorKind::stopped);
  scene_.environment = folder_ / "no.exr";
  EXPECT_THAT(Renderer::create(scene_, width, height).error().message(), HasSubstr("no.exr"));
}

/// One lamp off every axis in an environment, a floor that mirrors it about there, seen obliquely.
TEST_F(RendererTest, EveryPixelReflectsTheEnvironmentFromWhereItShines) {
  const Vec3 mirrored_at(-400, 0, 0), to_eye = (scene_.camera.position_mm - mirrored_at).normalized();
  const Vec3 source(-to_eye.x(), -to_eye.y(), to_eye.z());
  support::ExrFile sky(128, 64);
  std::vector<float> rgb(3 * 128 * 64, 0.1F);
  const auto [column, row] = LatLong(128, 64, rgb).pixel_at(source);
  for (std::size_t c = 0; c < 3; ++c) {
    rgb[static_cast<std::size_t>(3 * (row * 128 + column)) + c] = 300.0F + 100.0F * static_cast<float>(c);
    const std::string name(1, "RGB"[c]);
    sky.channels[name] = Imf::FLOAT;
    for (std::size_t k = c; k < rgb.size(); k += 3) sky.pixels[name].push_back(rgb[k]);
  }
  sky.write(folder_ / "sky.exr");
  scene_.environment = folder_ / "sky.exr";
  scene_.environment_scale = 0.5;
  scene_.materials["floor"] = {.specular = {{0.3, 0.2, 0.1}}, .exponent = 200};
  const LightField field = light_field_of(geometry_of({"Y"}));
  auto renderer = renderer_of(scene_, field.geometry());
  ASSERT_TRUE(renderer->add_all(field));
  const Picture on = *renderer->picture();
  ASSERT_TRUE(renderer->set_environment(false));
  const Picture off = *renderer->picture();

  const EnvironmentLight light(LatLong(128, 64, rgb), 0.5);
  const auto mesh = read_mesh(scene_.mesh, scene_.materials);
  auto context = EglContext::create();
  const auto g = (*GBufferPass::create(**context, *mesh))->draw(scene_.camera, width, height);
  double brightest = 0;
  Vec3 brightest_at(0, 0, 0);
  int walls = 0;
  for (std::size_t i = 0; i < on.coverage.size(); ++i) {
    if (on.coverage[i] == 0) continue;
    const Vec3 p(g->position[4 * i], g->position[4 * i + 1], g->position[4 * i + 2]);
    const Vec3 n(g->normal[4 * i], g->normal[4 * i + 1], g->normal[4 * i + 2]);
    const Material& m = mesh->materials[static_cast<std::size_t>(g->normal[4 * i + 3])];
    const Eigen::Vector3f o = (scene_.camera.position_mm - p).normalized().cast<float>();
    const auto gloss =
        light.gloss({o.x(), o.y(), o.z(), m.shape, m.specular[0], m.specular[1], m.specular[2], m.lobe}, n);
    for (std::size_t c = 0; c < 3; ++c) {
      const double wanted = m.diffuse[c] / std::numbers::pi * light.irradiance(n)[c] + gloss[c];
      EXPECT_NEAR(on.rgb[3 * i + c] - off.rgb[3 * i + c], wanted, 1e-4 * (1 + wanted)) << i << ' ' << c;
    }
    if (m.lobe == LOBE_NONE) ++walls;
    if (gloss[1] > brightest) {
      brightest = gloss[1];
      brightest_at = p;
    }
  }
  EXPECT_GT(walls, 20);
  EXPECT_GT(brightest, 1);
  EXPECT_LT((brightest_at - mirrored_at).norm(), 100) << brightest_at.transpose();
}

TEST_F(RendererTest, ReceiversThatDoNotFitIntoMemoryAreRefusedBeforeAnyIsTaken) {
  const LightField field = light_field_of(geometry_of({"Y"}));
  auto renderer = renderer_of(scene_, field.geometry());
  ASSERT_TRUE(renderer->add_all(field));
  const Picture before = *renderer->picture();
  // Positions, normals and faces alone take 48 bytes.
  const std::vector<ScenePlacement> many(most_luminaires, scene_.luminaires[0]);
  const int side = static_cast<int>(std::sqrt(host_memory_bytes() / 2 / (48.0 * most_luminaires))) + 1;
  ASSERT_TRUE(renderer->set_placements(many));
  ASSERT_TRUE(renderer->set_view(scene_.camera, side, side));
  for (const Status& refused : {renderer->hand_over(), Status(renderer->picture().map([](const Picture&) {}))}) {
    ASSERT_FALSE(refused);
    EXPECT_THAT(refused.error().message(), HasSubstr("pixels seen by 1000 luminaires take"));
  }
  ASSERT_TRUE(renderer->set_placements(scene_.luminaires));
  ASSERT_TRUE(renderer->set_view(scene_.camera, width, height));
  EXPECT_EQ(difference(before, *renderer->picture()), 0);
}

TEST_F(RendererTest, RefusesWhatDoesNotFit) {
  const LuminaireGeometry geometry = geometry_of({"Y"});
  auto bare = Renderer::create(scene_, width, height);
  ASSERT_TRUE(bare);
  EXPECT_THAT(bare.value()->picture().error().message(), HasSubstr("no luminaire is set"));
  EXPECT_EQ(bare.value()->info().left_out, "light from surface to surface");
  EXPECT_THAT(bare.value()->info().opengl, HasSubstr("OpenGL"));
  EXPECT_NE(bare.value()->info().opencl, "");
  auto renderer = renderer_of(scene_, geometry);
  EXPECT_THAT(renderer->add_cell({2, 0}, image_of(geometry, 1)).error().message(), HasSubstr("cell (2, 0)"));
  EXPECT_THAT(renderer->add_cell({0, 0}, image_of(geometry_of({"R", "G", "B"}), 1)).error().message(),
              HasSubstr("cell (0, 0)"));
  EXPECT_FALSE(renderer->add_cell({0, 0}, nullptr));
  LuminaireGeometry other = geometry;
  other.sampling.spacing_mm.x() += 1;
  EXPECT_THAT(renderer->add_all(light_field_of(other)).error().message(),
              HasSubstr("another luminaire: its sampling.spacing_mm.0 is"));
  CellImage broken_image = *image_of(geometry, 1);
  broken_image.value[1] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THAT(renderer->add_cell({0, 0}, std::make_shared<const CellImage>(broken_image)).error().message(),
              HasSubstr("cell (0, 0): channel Y: pixel (1, 0): holds NaN or Inf"));
  EXPECT_FALSE(renderer->set_luminaire(geometry_of({"Y", "Z"})));

  Scene broken = scene_;
  broken.luminaires.clear();
  EXPECT_THAT(Renderer::create(broken, width, height).error().message(), HasSubstr("no luminaire is placed"));
  broken = scene_;
  broken.luminaires[0].pose(0, 0) *= -1;
  EXPECT_THAT(Renderer::create(broken, width, height).error().message(), HasSubstr("luminaires[0]: the pose"));
  broken = scene_;
  broken.mesh = folder_ / "absent.obj";
  EXPECT_THAT(Renderer::create(broken, width, height).error().message(), HasSubstr("absent.obj: no such file"));
}

}  // namespace
}  // namespace lumifield
