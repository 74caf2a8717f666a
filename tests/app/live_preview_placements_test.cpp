#include <gmock/gmock.h>
#include <set>

#include "tests/app/live_preview_fixture.h"

namespace lumifield {
namespace {

class LivePreviewPlacementsTest : public LivePreviewTest {
 protected:
  /// The scene's lamp moved to the side, and, if told so, another.
  static std::vector<ScenePlacement> lamps(double x_mm, int count = 1) {
    std::vector<ScenePlacement> all(static_cast<std::size_t>(count));
    all.front().pose(0, 3) = x_mm;
    return all;
  }
  static auto stand(double x_mm, std::size_t count = 1) {
    return [=](const PreviewFrame& f) { return f.placements.size() == count && f.placements[0].pose(0, 3) == x_mm; };
  }
  Picture expected_with(const std::vector<ScenePlacement>& placements) {
    scene_.luminaires = placements;
    return expected(scene_.camera, all_);
  }
  /// Lit by all cells, its full picture shown.
  std::unique_ptr<LivePreview> lit() {
    auto live = hasty();
    live->set_scene(scene_);
    live->set_luminaire(geometry_);
    add_all(*live);
    EXPECT_NE(told_.full(all_), nullptr);
    return live;
  }
};

TEST_F(LivePreviewPlacementsTest, ALampThatMovesGetsCoarsePicturesAndTheFullOneWhenItRests) {
  auto live = lit();
  EXPECT_TRUE(stand(0)(*told_.all().back())) << "the scene's own";
  live->set_placements(lamps(100), true);
  const FramePtr coarse = told_.frame(stand(100));
  ASSERT_NE(coarse, nullptr);
  EXPECT_TRUE(coarse->coarse);
  EXPECT_LT(coarse->radiance->width_px, width);
  EXPECT_EQ(coarse->cells, all_);

  live->set_placements(lamps(100), false);
  const FramePtr full = told_.frame([](const PreviewFrame& f) { return !f.coarse && stand(100)(f); });
  ASSERT_NE(full, nullptr);
  EXPECT_EQ(full->cells, all_);
  expect_same(expected_with(lamps(100)), *full->radiance);
}

TEST_F(LivePreviewPlacementsTest, LampsComeAndGoAndTheirLightAddsUp) {
  auto live = lit();
  live->set_placements(lamps(-150, 2), false);
  const FramePtr two = told_.frame([](const PreviewFrame& f) { return !f.coarse && stand(-150, 2)(f); });
  ASSERT_NE(two, nullptr);
  expect_same(expected_with(lamps(-150, 2)), *two->radiance);
  live->set_placements(lamps(-150), false);
  const FramePtr one = told_.frame([](const PreviewFrame& f) { return !f.coarse && stand(-150)(f); });
  ASSERT_NE(one, nullptr);
  expect_same(expected_with(lamps(-150)), *one->radiance);
}

TEST_F(LivePreviewPlacementsTest, ALampThatNeverRestsIsShownAllTheSame) {
  auto live = lit();
  const std::size_t from = told_.frames();
  const auto end = std::chrono::steady_clock::now() + patience;
  const auto shown = [&] {
    std::set<double> places;
    const std::vector<FramePtr> frames = told_.all();
    for (std::size_t k = from; k < frames.size(); ++k)
      if (frames[k]->cells == all_) places.insert(frames[k]->placements.at(0).pose(0, 3));
    return places.size();
  };
  // Faster than a picture can be made.
  int moves = 0;
  while (shown() < 5 && std::chrono::steady_clock::now() < end) live->set_placements(lamps(++moves % 300), true);
  EXPECT_GE(shown(), 5u) << moves << " moves";
}

TEST_F(LivePreviewPlacementsTest, WhatIsRefusedIsToldAndLeavesThoseBefore) {
  auto live = lit();
  live->set_placements(lamps(100), false);
  ASSERT_NE(told_.frame([](const PreviewFrame& f) { return !f.coarse && stand(100)(f); }), nullptr);

  std::vector<ScenePlacement> skewed = lamps(200);
  skewed[0].pose(0, 1) = 0.5;
  std::size_t from = told_.frames();
  live->set_placements(skewed, false);
  ASSERT_TRUE(told_.failed(1));
  EXPECT_THAT(told_.errors().back(), testing::HasSubstr("luminaires[0]"));
  const FramePtr after = told_.frame([](const PreviewFrame& f) { return !f.coarse; }, from);
  ASSERT_NE(after, nullptr);
  EXPECT_TRUE(stand(100)(*after));
  EXPECT_EQ(after->cells, all_);

  live->set_placements({}, false);
  ASSERT_TRUE(told_.failed(2));
  EXPECT_THAT(told_.errors().back(), testing::HasSubstr("no luminaire is placed"));
  live->set_placements(lamps(50), false);  // and it goes on
  const FramePtr next = told_.frame([](const PreviewFrame& f) { return !f.coarse && stand(50)(f); });
  ASSERT_NE(next, nullptr);
  expect_same(expected_with(lamps(50)), *next->radiance);
}

TEST_F(LivePreviewPlacementsTest, AnotherSceneHasItsOwnLamps) {
  auto live = lit();
  live->set_placements(lamps(100), true);
  Scene other = scene_;
  other.luminaires = lamps(-80, 2);
  const std::size_t from = told_.frames();
  live->set_scene(other);
  ASSERT_TRUE(told_.ready(2));
  const FramePtr full = told_.frame([](const PreviewFrame& f) { return !f.coarse && stand(-80, 2)(f); }, from);
  ASSERT_NE(full, nullptr);
  EXPECT_TRUE(stand(-80, 2)(*told_.all().back()));
}

}  // namespace
}  // namespace lumifield
