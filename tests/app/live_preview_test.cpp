#include "app/session/live_preview.h"

#include <atomic>
#include <condition_variable>
#include <filesystem>
#include <fstream>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mutex>
#include <random>
#include <stdexcept>
#include <sys/resource.h>

#include "renderer/false_colour.h"

namespace lumifield {
namespace {

using testing::HasSubstr;
namespace fs = std::filesystem;
using FramePtr = std::shared_ptr<const PreviewFrame>;

constexpr int width = 64, height = 48;
/// For what must come: only a test that fails waits so long.
constexpr std::chrono::seconds patience(90);

LuminaireGeometry small_geometry() {
  LuminaireGeometry g;
  g.planes.separation_mm = 150;
  g.sampling = {BasisKind::bell, {7.5, 6}, 4, 3, {1, -2}};
  g.measurement = {40, 30, {6, 6}, {3, 1}};
  g.channels = {"Y"};
  g.quantity = Quantity::radiance;
  return g;
}

std::shared_ptr<const CellImage> image_of(const LuminaireGeometry& g, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> uniform(0.1F, 1);
  CellImage image{g.measurement.width_px, g.measurement.height_px, static_cast<int>(g.channels.size()), {}, {}, {}};
  image.value.resize(image.plane() * g.channels.size());
  for (float& v : image.value) v = uniform(random);
  return std::make_shared<const CellImage>(std::move(image));
}

/// What the callbacks told, to be waited for.
class Told {
  template <class Change>
  void note(Change&& change) {
    const std::lock_guard lock(mutex_);
    change();
    came_.notify_all();
  }
  template <class Until>
  bool wait(Until&& until) {
    std::unique_lock lock(mutex_);
    return came_.wait_for(lock, patience, until);
  }
  template <class Get>
  auto locked(Get&& get) {
    const std::lock_guard lock(mutex_);
    return get();
  }

 public:
  LivePreview::Callbacks callbacks() {
    return {[this](FramePtr frame) { note([&] { frames_.push_back(std::move(frame)); }); },
            [this](const RendererInfo& info) { note([&] { ready_.push_back(info); }); },
            [this](const Error& error) { note([&] { errors_.push_back(error.message()); }); }};
  }
  /// The first frame from the `from`-th on that is as wanted; null when none comes.
  template <class Wanted>
  FramePtr frame(Wanted&& wanted, std::size_t from = 0) {
    std::unique_lock lock(mutex_);
    FramePtr found;
    came_.wait_for(lock, patience, [&] {
      for (; !found && from < frames_.size(); ++from)
        if (wanted(*frames_[from])) found = frames_[from];
      return found != nullptr;
    });
    return found;
  }
  FramePtr full(int cells, std::size_t from = 0) {
    return frame([&](const PreviewFrame& f) { return !f.coarse && f.cells == cells; }, from);
  }
  bool ready(std::size_t times) {
    return wait([&] { return ready_.size() >= times; });
  }
  bool failed(std::size_t times) {
    return wait([&] { return errors_.size() >= times; });
  }
  std::size_t frames() {
    return locked([&] { return frames_.size(); });
  }
  std::vector<FramePtr> all() {
    return locked([&] { return frames_; });
  }
  std::vector<std::string> errors() {
    return locked([&] { return errors_; });
  }
  RendererInfo info() {
    return locked([&] { return ready_.back(); });
  }

 private:
  std::mutex mutex_;
  std::condition_variable came_;
  std::vector<FramePtr> frames_;
  std::vector<RendererInfo> ready_;
  std::vector<std::string> errors_;
};

class LivePreviewTest : public testing::Test {
 protected:
  void SetUp() override {
    if (const auto gl = probe_opengl(); !gl) GTEST_SKIP() << gl.error().message();
    if (const auto cl = probe_opencl(); !cl) GTEST_SKIP() << cl.error().message();
    std::string path = (fs::temp_directory_path() / "live_preview_test_XXXXXX").string();
    ASSERT_NE(mkdtemp(path.data()), nullptr);
    folder_ = path;
    std::ofstream(folder_ / "room.mtl") << "newmtl floor\nKd 0.5 0.25 0.75\n";
    std::ofstream(folder_ / "room.obj") << "mtllib room.mtl\nv -800 -500 900\nv 800 -500 900\nv 800 700 900\n"
                                           "v -800 700 900\nusemtl floor\nf 1 2 3 4\n";
    scene_.mesh = folder_ / "room.obj";
    scene_.camera.position_mm = {300, -1200, 100};
    scene_.camera.target_mm = {0, 200, 900};
    scene_.luminaires = {{}};
  }
  void TearDown() override {
    if (!folder_.empty()) fs::remove_all(folder_);
  }
  std::unique_ptr<LivePreview> preview(PreviewPace pace = {}) {
    auto made = std::make_unique<LivePreview>(told_.callbacks(), pace);
    made->set_size(width, height);
    return made;
  }
  /// One whose moving pictures are the coarsest, however quick the machine.
  std::unique_ptr<LivePreview> hasty() { return preview({.coarse = 0}); }
  SceneCamera camera(double x_mm) const {
    SceneCamera moved = scene_.camera;
    moved.position_mm.x() = x_mm;
    return moved;
  }
  void add_all(LivePreview& to) {
    for (int k = 0; k < geometry_.sampling.cells(); ++k)
      to.add(geometry_.sampling.index(k), image_of(geometry_, static_cast<unsigned>(k)));
  }
  /// As the renderer makes it at one go. `retaken` is the last cell's image, where it is another.
  Picture expected(const SceneCamera& camera, int cells, int width_px = width, int height_px = height,
                   unsigned retaken = 0) {
    Scene scene = scene_;
    scene.camera = camera;
    auto renderer = Renderer::create(scene, width_px, height_px);
    EXPECT_TRUE(renderer && (*renderer)->set_luminaire(geometry_));
    for (int k = 0; k < cells; ++k)
      EXPECT_TRUE(
          (*renderer)->add_cell(geometry_.sampling.index(k),
                                image_of(geometry_, retaken && k + 1 == cells ? retaken : static_cast<unsigned>(k))));
    return *(*renderer)->picture();
  }
  static void expect_same(const Picture& a, const Picture& b) {
    ASSERT_EQ(a.width_px, b.width_px);
    ASSERT_EQ(a.coverage, b.coverage);
    float most = 0, apart = 0;
    for (std::size_t i = 0; i < a.rgb.size(); ++i) {
      most = std::max(most, a.rgb[i]);
      apart = std::max(apart, std::abs(a.rgb[i] - b.rgb[i]));
    }
    EXPECT_GT(most, 0);
    EXPECT_LE(apart, 1e-6F * most);
  }

  fs::path folder_;
  Scene scene_;
  LuminaireGeometry geometry_ = small_geometry();
  int all_ = geometry_.sampling.cells();
  Told told_;
};

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
