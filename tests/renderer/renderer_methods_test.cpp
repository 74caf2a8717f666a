// A picture by another method than the closed form, as its cells come and change.
#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>

#include "renderer/renderer.h"
#include "renderer/study/synthetic_luminaire.h"
#include "tests/support/apart.h"

namespace lumifield {
namespace {

using test::apart;

class RendererMethods : public testing::Test {
 protected:
  void SetUp() override {
    if (const auto gl = probe_opengl(); !gl) GTEST_SKIP() << gl.error().message();
    if (const auto cl = probe_opencl(); !cl) GTEST_SKIP() << cl.error().message();
    scene_ = read_scene(std::string(LUMIFIELD_SOURCE_DIR) + "/resources/scenes/corner/scene.json").value();
    renderer_ = Renderer::create(scene_, 80, 60).value();
  }

  /// A picture of finite values in which most of what is covered is lit.
  static Picture lit(const Result<Picture>& shown) {
    Picture picture = shown.value();
    int covered = 0, bright = 0;
    for (std::size_t k = 0; k < picture.rgb.size(); ++k) {
      EXPECT_TRUE(std::isfinite(picture.rgb[k]));
      covered += picture.coverage[k / 3] > 0;
      bright += picture.rgb[k] > 0;
    }
    EXPECT_GT(bright, covered / 2);
    EXPECT_GT(covered, 0);
    return picture;
  }
  Picture by(const MethodSettings& settings) {
    EXPECT_TRUE(renderer_->set_method(settings));
    EXPECT_GT(renderer_->waiting(), 0);
    return lit(renderer_->picture());
  }

  LightField field_ = make_luminaire({.name = "small", .columns = 3, .rows = 2, .pixels = 75, .pixel_mm = 4});
  Scene scene_;
  std::unique_ptr<Renderer> renderer_;
};

TEST_F(RendererMethods, GiveThePictureWithinTheirErrors) {
  ASSERT_TRUE(renderer_->set_luminaire(field_.geometry()));
  ASSERT_TRUE(renderer_->add_all(field_));
  const Picture exact = lit(renderer_->picture());
  EXPECT_LT(apart(by({.method = Method::reference}), exact), 1e-6);
  EXPECT_LT(apart(by({.method = Method::position_dependent, .samples = 2000}), exact), 0.05);
  EXPECT_LT(apart(by({.method = Method::uniform_box, .samples = 2000}), exact), 0.05);
  EXPECT_LT(apart(by({.method = Method::far_field}), exact), 0.2);
  EXPECT_GT(apart(by({.method = Method::far_field}), exact), 1e-4);
  EXPECT_GT(apart(by({.method = Method::position_dependent, .samples = 20}), exact), 0.01);
  EXPECT_EQ(apart(by({}), exact), 0) << "and back";
}

TEST_F(RendererMethods, TellHowMuchIsDoneOfWhatIsSummedInPieces) {
  ASSERT_TRUE(renderer_->set_luminaire(field_.geometry()));
  EXPECT_EQ(renderer_->share_surrounded(), 1) << "of an environment that is not";
  for (const MethodSettings& settings :
       {MethodSettings{}, {.method = Method::position_dependent, .samples = 100}, {.method = Method::reference}}) {
    ASSERT_TRUE(renderer_->set_method(settings));
    ASSERT_TRUE(renderer_->add_all(field_));
    const Picture at_once = lit(renderer_->picture());
    ASSERT_TRUE(renderer_->keep_all(field_));
    EXPECT_EQ(renderer_->waiting(), 6);
    std::vector<double> shares{renderer_->share_summed()};
    while (renderer_->waiting() > 0) {
      ASSERT_TRUE(renderer_->sum_some(0));
      shares.push_back(renderer_->share_summed());
    }
    EXPECT_GT(shares.size(), 2u);
    EXPECT_TRUE(std::ranges::is_sorted(shares));
    EXPECT_EQ(shares.back(), 1);
    EXPECT_LT(shares[shares.size() - 2], 1);
    EXPECT_LT(apart(lit(renderer_->picture()), at_once), 1e-6) << to_string(settings.method);
  }
}

TEST_F(RendererMethods, ACellThatComesOrChangesCountsWithAllOthers) {
  const MethodSettings settings{.method = Method::position_dependent, .samples = 100};
  ASSERT_TRUE(renderer_->set_method(settings)) << "before there is a luminaire";
  ASSERT_TRUE(renderer_->set_luminaire(field_.geometry()));
  for (int k = 0; k < 6; ++k) {
    ASSERT_TRUE(renderer_->keep_cell({k / 3, k % 3}, field_.cell({k / 3, k % 3})));
    EXPECT_EQ(renderer_->waiting(), k + 1) << "those before share the samples";
    ASSERT_TRUE(renderer_->picture());
    EXPECT_EQ(renderer_->waiting(), 0);
    EXPECT_EQ(renderer_->summed(), k + 1);
  }
  CellImage twice = *field_.cell({0, 1});
  for (float& v : twice.value) v *= 2;
  ASSERT_TRUE(field_.add({0, 1}, std::move(twice)));
  ASSERT_TRUE(renderer_->add_cell({0, 1}, field_.cell({0, 1})));
  const Picture one_by_one = lit(renderer_->picture());

  const auto fresh = Renderer::create(scene_, 80, 60).value();
  ASSERT_TRUE(fresh->set_method(settings));
  ASSERT_TRUE(fresh->set_luminaire(field_.geometry()));
  ASSERT_TRUE(fresh->add_all(field_));
  EXPECT_EQ(fresh->picture().value().rgb, one_by_one.rgb);
}

TEST_F(RendererMethods, AllCellsGivenAgainAreThoseThatLight) {
  ASSERT_TRUE(renderer_->set_method({.method = Method::position_dependent, .samples = 50}));
  ASSERT_TRUE(renderer_->set_luminaire(field_.geometry()));
  ASSERT_TRUE(renderer_->add_all(field_));
  const Picture before = lit(renderer_->picture());
  for (int k = 0; k < 6; ++k) {
    CellImage twice = *field_.cell({k / 3, k % 3});
    for (float& v : twice.value) v *= 2;
    ASSERT_TRUE(field_.add({k / 3, k % 3}, std::move(twice)));
  }
  ASSERT_TRUE(renderer_->add_all(field_));
  const Picture after = renderer_->picture().value();
  for (std::size_t k = 0; k < after.rgb.size(); ++k) ASSERT_NEAR(after.rgb[k], 2 * before.rgb[k], 1e-5 * after.rgb[k]);
}

TEST_F(RendererMethods, AreComputedInPiecesWithoutAHalfPicture) {
  ASSERT_TRUE(renderer_->set_method({.method = Method::reference}));
  ASSERT_TRUE(renderer_->set_luminaire(field_.geometry()));
  ASSERT_TRUE(renderer_->add_all(field_));
  const Picture whole = lit(renderer_->picture());
  ASSERT_TRUE(renderer_->keep_cell({0, 0}, field_.cell({0, 0})));
  int pieces = 0;
  while (renderer_->waiting() > 0) {
    ASSERT_EQ(renderer_->picture_so_far().value().rgb, whole.rgb) << "as it was until all is done";
    ASSERT_TRUE(renderer_->sum_some(0));
    ++pieces;
  }
  EXPECT_GT(pieces, 3);
  EXPECT_EQ(renderer_->picture_so_far().value().rgb, whole.rgb);

  ASSERT_TRUE(renderer_->set_view(scene_.camera, 40, 30));
  EXPECT_EQ(renderer_->picture_so_far().value().rgb, std::vector<float>(3 * 40 * 30, 0.0F)) << "another view is dark";
}

TEST_F(RendererMethods, ALuminaireThatCannotBeTakenLeavesThePicture) {
  ASSERT_TRUE(renderer_->set_method({.method = Method::position_dependent, .samples = 50}));
  ASSERT_TRUE(renderer_->set_luminaire(field_.geometry()));
  ASSERT_TRUE(renderer_->add_all(field_));
  const Picture before = lit(renderer_->picture());
  LuminaireGeometry large = field_.geometry();
  large.measurement.width_px = large.measurement.height_px = 50000;
  ASSERT_FALSE(renderer_->set_luminaire(large));
  EXPECT_EQ(renderer_->waiting(), 0);
  EXPECT_EQ(renderer_->picture().value().rgb, before.rgb);
}

TEST_F(RendererMethods, WhatCannotBeTakenLeavesAllAsItWas) {
  ASSERT_TRUE(renderer_->set_luminaire(field_.geometry()));
  ASSERT_TRUE(renderer_->add_all(field_));
  const Picture exact = lit(renderer_->picture());
  EXPECT_FALSE(renderer_->set_method({.method = Method::position_dependent, .samples = 0}));
  EXPECT_EQ(renderer_->picture().value().rgb, exact.rgb);

  // A negative cell shows when the picture is asked for; another method brings it.
  CellImage negative = *field_.cell({1, 2});
  negative.value[3] = -1;
  ASSERT_TRUE(field_.add({1, 2}, std::move(negative)));
  ASSERT_TRUE(renderer_->keep_cell({1, 2}, field_.cell({1, 2})));
  ASSERT_TRUE(renderer_->set_method({.method = Method::position_dependent_printed}));
  const auto refused = renderer_->picture();
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().where, "cell (1, 2), pixel (3, 0)");
  ASSERT_TRUE(renderer_->set_method({}));
  lit(renderer_->picture());
}

}  // namespace
}  // namespace lumifield
