#include <gmock/gmock.h>

#include "tests/app/live_preview_fixture.h"

namespace lumifield {
namespace {

using testing::HasSubstr;

TEST_F(LivePreviewTest, AMethodThatIsChosenMakesThePicture) {
  auto live = preview();
  live->set_scene(scene_);
  live->set_luminaire(geometry_);
  add_all(*live);
  ASSERT_NE(told_.full(all_), nullptr);

  const MethodSettings settings{.method = Method::position_dependent, .samples = 40, .seed = 3};
  std::size_t from = told_.frames();
  live->set_method(settings);
  const auto by = [&](Method method) {
    return [method, this](const PreviewFrame& f) { return f.method.method == method && !f.coarse && f.cells == all_; };
  };
  const FramePtr sampled = told_.frame(by(Method::position_dependent), from);
  ASSERT_NE(sampled, nullptr);

  // As a renderer makes it at one go.
  auto renderer = Renderer::create(scene_, width, height).value();
  ASSERT_TRUE(renderer->set_method(settings));
  ASSERT_TRUE(renderer->set_luminaire(geometry_));
  for (int k = 0; k < all_; ++k)
    ASSERT_TRUE(renderer->keep_cell(geometry_.sampling.index(k), image_of(geometry_, static_cast<unsigned>(k))));
  expect_same(renderer->picture().value(), *sampled->radiance);

  // It stays with another scene, and goes back.
  from = told_.frames();
  live->set_scene(scene_);
  ASSERT_NE(told_.frame(by(Method::position_dependent), from), nullptr);
  from = told_.frames();
  live->set_method({});
  const FramePtr exact = told_.frame(by(Method::closed_form), from);
  ASSERT_NE(exact, nullptr);
  expect_same(expected(scene_.camera, all_), *exact->radiance);
  EXPECT_TRUE(told_.errors().empty());
}

TEST_F(LivePreviewTest, AMethodThatIsRefusedLeavesTheOneBefore) {
  auto live = preview();
  live->set_scene(scene_);
  live->set_luminaire(geometry_);
  add_all(*live);
  ASSERT_NE(told_.full(all_), nullptr);
  live->set_method({.method = Method::uniform_box, .samples = 0});
  ASSERT_TRUE(told_.failed(1));
  EXPECT_THAT(told_.errors()[0], HasSubstr("number of samples"));
  const std::size_t from = told_.frames();
  live->set_camera(camera(-200), false);
  const FramePtr frame = told_.full(all_, from);
  ASSERT_NE(frame, nullptr);
  EXPECT_EQ(frame->method.method, Method::closed_form);
}

}  // namespace
}  // namespace lumifield
