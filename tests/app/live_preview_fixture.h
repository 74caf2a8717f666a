#pragma once

#include <algorithm>
#include <condition_variable>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <mutex>
#include <random>

#include "app/session/live_preview.h"

namespace lumifield {

using FramePtr = std::shared_ptr<const PreviewFrame>;

inline constexpr int width = 64, height = 48;
/// For what must come: only a test that fails waits so long.
inline constexpr std::chrono::seconds patience(90);

inline LuminaireGeometry small_geometry() {
  LuminaireGeometry g;
  g.planes.separation_mm = 150;
  g.sampling = {BasisKind::bell, {7.5, 6}, 4, 3, {1, -2}};
  g.measurement = {40, 30, {6, 6}, {3, 1}};
  g.channels = {"Y"};
  g.quantity = Quantity::radiance;
  return g;
}

inline std::shared_ptr<const CellImage> image_of(const LuminaireGeometry& g, unsigned seed) {
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
            [this](const Error& error) { note([&] { errors_.push_back(error.message()); }); },
            [this](const PreviewProgress& progress) { note([&] { progress_.push_back(progress); }); }};
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
  /// Whether some progress is told, or has been, that is as wanted.
  template <class Wanted>
  bool progress(Wanted&& wanted) {
    return wait([&] { return std::ranges::any_of(progress_, wanted); });
  }
  PreviewProgress last_progress() {
    return locked([&] { return progress_.back(); });
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
  std::vector<PreviewProgress> progress_;
};

/// A room with one wall, a luminaire of 4 × 3 cells, and what the callbacks told.
class LivePreviewTest : public testing::Test {
 protected:
  void SetUp() override {
    if (const auto gl = probe_opengl(); !gl) GTEST_SKIP() << gl.error().message();
    if (const auto cl = probe_opencl(); !cl) GTEST_SKIP() << cl.error().message();
    std::string path = (std::filesystem::temp_directory_path() / "live_preview_test_XXXXXX").string();
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
    if (!folder_.empty()) std::filesystem::remove_all(folder_);
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

  std::filesystem::path folder_;
  Scene scene_;
  LuminaireGeometry geometry_ = small_geometry();
  int all_ = geometry_.sampling.cells();
  Told told_;
};

}  // namespace lumifield
