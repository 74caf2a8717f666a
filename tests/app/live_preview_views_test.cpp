#include "tests/app/live_preview_fixture.h"

namespace lumifield {
namespace {

TEST_F(LivePreviewTest, AMovingCameraGetsCoarsePicturesAndTheFullOneWhenItRests) {
  auto live = hasty();
  live->set_scene(scene_);
  live->set_luminaire(geometry_);
  add_all(*live);
  ASSERT_NE(told_.full(all_), nullptr);
  const auto at = [](double x_mm) {
    return [x_mm](const PreviewFrame& f) { return f.camera.position_mm.x() == x_mm; };
  };
  live->set_camera(camera(200), true);
  const FramePtr coarse = told_.frame(at(200));
  ASSERT_NE(coarse, nullptr);
  EXPECT_TRUE(coarse->coarse);
  EXPECT_LT(coarse->radiance->width_px, width);
  EXPECT_EQ(coarse->shown.width_px, coarse->radiance->width_px);
  EXPECT_EQ(coarse->cells, all_);

  // A cell while it moves is shown at once, coarsely.
  std::size_t from = told_.frames();
  live->add({0, 0}, image_of(geometry_, 77));
  ASSERT_NE(
      told_.frame([](const PreviewFrame& f) { return f.coarse && f.handed_in.time_since_epoch().count() != 0; }, from),
      nullptr);

  // It rests where it is: the full picture follows and is exact.
  live->set_camera(camera(200), false);
  const FramePtr full =
      told_.frame([&](const PreviewFrame& f) { return !f.coarse && f.camera.position_mm.x() == 200; });
  ASSERT_NE(full, nullptr);
  EXPECT_GT(full->draw_s, 0) << "the first of its view";
  EXPECT_EQ(full->radiance->width_px, width);
  EXPECT_EQ(full->cells, all_);
}

TEST_F(LivePreviewTest, ACameraThatNeverRestsIsShownAllTheSame) {
  for (const double coarse : {0.0, 1e3}) {  // coarse pictures, and full ones of a camera that moves
    auto live = preview({.coarse = coarse});
    live->set_scene(scene_);
    live->set_luminaire(geometry_);
    add_all(*live);
    const std::size_t from = told_.frames();
    const auto end = std::chrono::steady_clock::now() + patience;
    int moves = 0;
    const auto shown = [&] {
      double last = -1;
      int count = 0;
      const std::vector<FramePtr> frames = told_.all();
      for (std::size_t k = from; k < frames.size(); ++k) {
        if (frames[k]->camera.position_mm.x() == last) continue;
        last = frames[k]->camera.position_mm.x();
        if (frames[k]->cells == all_) ++count;
      }
      return count;
    };
    // Faster than a picture can be drawn.
    while (shown() < 5 && std::chrono::steady_clock::now() < end) live->set_camera(camera(++moves % 900), true);
    EXPECT_GE(shown(), 5) << moves << " moves";
  }
}

TEST_F(LivePreviewTest, ANewerViewInterruptsAndTheLatestCounts) {
  std::mutex gate;
  LivePreview::Callbacks callbacks = told_.callbacks();
  callbacks.frame = [&, note = callbacks.frame](FramePtr frame) {
    const std::lock_guard lock(gate);
    note(std::move(frame));
  };
  auto live = std::make_unique<LivePreview>(callbacks, PreviewPace{.coarse = 0});
  live->set_size(1024, 768);
  live->set_scene(scene_);
  live->set_luminaire(geometry_);
  add_all(*live);
  // Each view comes while the one before is being made; none but the last must be shown in full.
  for (int k = 0; k < 6; ++k) {
    const std::size_t from = told_.frames();
    live->set_camera(camera(10 * k), false);
    ASSERT_NE(told_.frame([&](const PreviewFrame& f) { return f.camera.position_mm.x() == 10 * k; }, from), nullptr);
  }

  // Many come while a frame is handed out.
  {
    const std::lock_guard lock(gate);
    for (int k = 0; k < 100; ++k) live->set_camera(camera(1000 + k), k < 99);
    live->set_size(width, height);
  }
  const FramePtr last =
      told_.frame([](const PreviewFrame& f) { return !f.coarse && f.camera.position_mm.x() == 1099; });
  ASSERT_NE(last, nullptr);
  EXPECT_EQ(last->radiance->width_px, width);
  expect_same(expected(camera(1099), all_), *last->radiance);
  int moved = 0;
  for (const FramePtr& frame : told_.all()) moved += frame->camera.position_mm.x() >= 1000;
  EXPECT_LE(moved, 3) << "one that was begun, a coarse and a full one of the last";
}

}  // namespace
}  // namespace lumifield
