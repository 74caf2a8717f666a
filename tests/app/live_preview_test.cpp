#include <gmock/gmock.h>

#include "renderer/false_colour.h"
#include "tests/app/live_preview_fixture.h"

namespace lumifield {
namespace {

using testing::HasSubstr;

TEST_F(LivePreviewTest, FramesAreTheRenderersPicturesOfTheSameCells) {
  const auto before = std::chrono::steady_clock::now();
  auto live = preview();
  live->set_scene(scene_);
  ASSERT_TRUE(told_.ready(1));
  EXPECT_THAT(told_.info().opengl, HasSubstr("OpenGL"));
  live->set_luminaire(geometry_);
  for (int k = 0; k < 3; ++k) {
    live->add(geometry_.sampling.index(k), image_of(geometry_, static_cast<unsigned>(k)));
    const FramePtr frame = told_.full(k + 1);
    ASSERT_NE(frame, nullptr);
    expect_same(expected(scene_.camera, k + 1), *frame->radiance);
    EXPECT_EQ(frame->total, all_);
    EXPECT_GT(frame->handed_in, before);
    EXPECT_GT(frame->sum_s, 0);
    EXPECT_EQ(frame->luminaire, 1U);
    EXPECT_EQ(frame->average, average_luminance(*frame->radiance));
    EXPECT_EQ(frame->shown.srgb, tone_map(*frame->radiance, frame->look.tone).srgb);
  }
  EXPECT_TRUE(told_.errors().empty());
}

TEST_F(LivePreviewTest, CellsOfABurstAllCountAndNoneIsLost) {
  auto live = preview();
  live->set_scene(scene_);
  live->set_luminaire(geometry_);
  add_all(*live);
  FramePtr frame = told_.full(all_);
  ASSERT_NE(frame, nullptr);
  expect_same(expected(scene_.camera, all_), *frame->radiance);

  // Frames never have fewer cells than those before.
  int cells = 0;
  for (const FramePtr& each : told_.all()) {
    EXPECT_GE(each->cells, cells);
    cells = each->cells;
  }

  // Of one a pass alone is shown, and said to be, until the whole cell comes.
  std::size_t from_half = told_.frames();
  live->add(geometry_.sampling.index(0), image_of(geometry_, 500), true);
  ASSERT_NE(told_.frame([](const PreviewFrame& f) { return f.half == 1; }, from_half), nullptr);
  from_half = told_.frames();
  live->add(geometry_.sampling.index(0), image_of(geometry_, 0));
  ASSERT_NE(told_.frame([](const PreviewFrame& f) { return f.half == 0; }, from_half), nullptr);

  // A cell taken again replaces the first; with the scan running too.
  live->set_scan_running(true);
  const std::size_t from = told_.frames();
  live->add(geometry_.sampling.index(all_ - 1), image_of(geometry_, 500));
  frame = told_.frame([](const PreviewFrame& f) { return f.handed_in.time_since_epoch().count() != 0; }, from);
  ASSERT_NE(frame, nullptr);
  expect_same(expected(scene_.camera, all_, width, height, 500), *frame->radiance);
}

TEST_F(LivePreviewTest, ADatasetThatOpensIsShownCoarselyAndThenInFull) {
  auto live = preview({.coarse = 0, .moment = 3600});
  live->set_size(1024, 768);
  live->set_luminaire(geometry_);
  for (int k = 0; k + 1 < all_; ++k)
    live->add(geometry_.sampling.index(k), image_of(geometry_, static_cast<unsigned>(k)));
  live->set_scene(scene_);
  const FramePtr coarse = told_.frame([&](const PreviewFrame& f) { return f.coarse && f.cells == all_ - 1; });
  ASSERT_NE(coarse, nullptr);
  expect_same(expected(scene_.camera, all_ - 1, coarse->radiance->width_px, coarse->radiance->height_px),
              *coarse->radiance);

  // The last one needs no moment of rest.
  live->add(geometry_.sampling.index(all_ - 1), image_of(geometry_, static_cast<unsigned>(all_ - 1)));
  const FramePtr full = told_.full(all_);
  ASSERT_NE(full, nullptr);
  EXPECT_EQ(full->radiance->width_px, 1024);
}

TEST_F(LivePreviewTest, ALookShowsAgainWithoutSumming) {
  auto live = preview();
  live->set_scene(scene_);
  live->set_luminaire(geometry_);
  add_all(*live);
  const FramePtr first = told_.full(all_);
  ASSERT_NE(first, nullptr);
  for (int k = 1; k <= 50; ++k) live->set_look({.tone = {0.1 * k, 0}});
  const FramePtr bright = told_.frame([](const PreviewFrame& f) { return f.look.tone.exposure == 0.1 * 50; });
  ASSERT_NE(bright, nullptr);
  EXPECT_EQ(bright->radiance, first->radiance) << "the same values";
  EXPECT_EQ(bright->draw_s, 0);
  EXPECT_EQ(bright->sum_s, 0);
  EXPECT_EQ(bright->handed_in.time_since_epoch().count(), 0);
  EXPECT_EQ(bright->shown.srgb, tone_map(*first->radiance, {5, 0}).srgb);

  live->set_look({.tone = {1, 0}, .false_colour = true});
  const FramePtr coloured = told_.frame([](const PreviewFrame& f) { return f.look.false_colour; });
  ASSERT_NE(coloured, nullptr);
  EXPECT_EQ(coloured->scale_top, largest_luminance(*first->radiance));
  EXPECT_EQ(coloured->shown.srgb, false_colours(*first->radiance, 0).srgb);
  live->set_look({.tone = {1, 0}, .false_colour = true, .false_colour_top = 3});
  ASSERT_NE(told_.frame([](const PreviewFrame& f) { return f.scale_top == 3; }), nullptr);
}

}  // namespace
}  // namespace lumifield
