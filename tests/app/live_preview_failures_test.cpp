#include <atomic>
#include <gmock/gmock.h>
#include <stdexcept>
#include <sys/resource.h>

#include "tests/app/live_preview_fixture.h"

namespace lumifield {
namespace {

using testing::HasSubstr;

TEST_F(LivePreviewTest, ASceneThatFailsLeavesRoomForOneThatWorks) {
  auto live = preview();
  Scene absent = scene_;
  absent.mesh = folder_ / "absent.obj";
  live->set_scene(absent);
  ASSERT_TRUE(told_.failed(1));
  EXPECT_THAT(told_.errors().back(), HasSubstr("absent.obj: no such file"));
  live->set_luminaire(geometry_);
  add_all(*live);
  EXPECT_EQ(told_.frames(), 0U);
  live->set_scene(scene_);
  ASSERT_NE(told_.full(all_), nullptr) << "the cells that came before count";
  live->set_scene(absent);
  ASSERT_TRUE(told_.failed(2));
  const std::size_t from = told_.frames();
  live->set_scene(scene_);
  const FramePtr again = told_.full(all_, from);
  ASSERT_NE(again, nullptr);
  expect_same(expected(scene_.camera, all_), *again->radiance);
  EXPECT_EQ(again->handed_in.time_since_epoch().count(), 0) << "no cell is new";
}

TEST_F(LivePreviewTest, AViewThatFailsIsToldOnceAndAnotherWorks) {
  auto live = preview();
  live->set_scene(scene_);
  live->set_luminaire(geometry_);
  add_all(*live);
  ASSERT_NE(told_.full(all_), nullptr);
  SceneCamera nowhere = scene_.camera;
  nowhere.target_mm = nowhere.position_mm;
  live->set_camera(nowhere, false);
  ASSERT_TRUE(told_.failed(1));
  EXPECT_THAT(told_.errors().back(), HasSubstr("no direction of view"));
  live->add({0, 0}, image_of(geometry_, 9));
  live->set_size(0, 48);
  live->set_camera(camera(5), false);
  ASSERT_TRUE(told_.failed(2));
  EXPECT_THAT(told_.errors().back(), HasSubstr("0x48 pixels"));
  const std::size_t from = told_.frames();
  live->set_size(width, height);
  ASSERT_NE(told_.full(all_, from), nullptr);
  EXPECT_EQ(told_.errors().size(), 2U);
}

TEST_F(LivePreviewTest, CellsThatDoNotFitAreRefused) {
  auto live = preview();
  live->add({1, 2}, image_of(geometry_, 1));
  ASSERT_TRUE(told_.failed(1));
  EXPECT_THAT(told_.errors().back(), HasSubstr("cell (1, 2): there is no luminaire yet"));
  live->set_scene(scene_);
  live->set_luminaire(geometry_);
  live->add({0, 0}, nullptr);
  live->add({9, 9}, image_of(geometry_, 1));
  ASSERT_TRUE(told_.failed(3));
  live->add({0, 0}, image_of(geometry_, 0));
  const FramePtr frame = told_.full(1);
  ASSERT_NE(frame, nullptr);
  expect_same(expected(scene_.camera, 1), *frame->radiance);

  // Another luminaire forgets the cells; one that cannot be shown is told.
  LuminaireGeometry other = geometry_;
  other.channels = {"A", "B"};
  live->set_luminaire(other);
  ASSERT_TRUE(told_.failed(4));
  const std::size_t from = told_.frames();
  live->set_luminaire(geometry_);
  live->add({0, 0}, image_of(geometry_, 0));
  const FramePtr again = told_.full(1, from);
  ASSERT_NE(again, nullptr);
  EXPECT_EQ(live->luminaire(), 3U);
  EXPECT_EQ(again->luminaire, 3U);
}

TEST_F(LivePreviewTest, WhatACallbackThrowsIsReportedAndTheThreadLives) {
  std::atomic<bool> throws = true;
  LivePreview::Callbacks callbacks = told_.callbacks();
  callbacks.frame = [&, note = callbacks.frame](FramePtr frame) {
    if (throws.exchange(false)) throw std::runtime_error("no room on the screen");
    note(std::move(frame));
  };
  LivePreview live(callbacks);
  live.set_size(width, height);
  live.set_scene(scene_);
  live.set_luminaire(geometry_);
  add_all(live);
  ASSERT_TRUE(told_.failed(1));
  EXPECT_THAT(told_.errors().back(), HasSubstr("no room on the screen"));
  live.set_scene(scene_);
  ASSERT_NE(told_.full(all_), nullptr);
}

TEST_F(LivePreviewTest, YieldsToOthersForLife) {
  std::atomic<int> niceness = -100;
  LivePreview::Callbacks callbacks = told_.callbacks();
  callbacks.ready = [&, note = callbacks.ready](const RendererInfo& info) {
    niceness = getpriority(PRIO_PROCESS, 0);
    note(info);
  };
  const int own = getpriority(PRIO_PROCESS, 0);
  LivePreview live(callbacks);
  live.set_scene(scene_);
  ASSERT_TRUE(told_.ready(1));
  EXPECT_EQ(niceness, std::max(own, 10));
  EXPECT_EQ(getpriority(PRIO_PROCESS, 0), own) << "this thread does not";
}

TEST_F(LivePreviewTest, EndsAmidWork) {
  // Before a scene, in the making of a renderer, of the first picture, and of a full one.
  for (int k = 0; k < 4; ++k) {
    Told told;
    std::atomic<bool> ended = false, late = false;
    {
      LivePreview::Callbacks callbacks = told.callbacks();
      callbacks.frame = [&, note = callbacks.frame](FramePtr frame) {
        late = late || ended;
        note(std::move(frame));
      };
      LivePreview live(callbacks, {.coarse = 0});
      if (k > 0) live.set_scene(scene_);
      live.set_luminaire(geometry_);
      add_all(live);
      if (k > 1) {
        ASSERT_TRUE(told.ready(1));
      }
      if (k > 2) {
        ASSERT_NE(told.frame([](const PreviewFrame& f) { return f.coarse; }), nullptr);
      }
      live.set_camera(camera(k), k % 2 == 0);
    }
    ended = true;
    EXPECT_FALSE(late);
    EXPECT_TRUE(told.errors().empty());
  }
}

}  // namespace
}  // namespace lumifield
