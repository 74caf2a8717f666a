// What the live preview takes: cell handed in → frame, full picture after a change of view, pictures a second while the
// camera moves. 63 cells of 300×300 pixels, one channel, the demo's corner. Not a test: run it alone on the machine.
//
//   preview_latency [width height]

#include <algorithm>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <cstdio>
#include <cstdlib>
#include <mutex>
#include <random>
#include <thread>
#include <vector>

#include "app/session/live_preview.h"

namespace lumifield {
namespace {

using Clock = std::chrono::steady_clock;

double ms(Clock::duration d) { return std::chrono::duration<double, std::milli>(d).count(); }

double quantile(std::vector<double> values, double share) {
  if (values.empty()) return std::nan("");
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1) + 0.5)];
}

LuminaireGeometry bike_light() {
  LuminaireGeometry g;
  g.planes.separation_mm = 150;
  g.sampling = {BasisKind::bell, {7.5, 7.5}, 9, 7, {0, 0}};
  g.measurement = {300, 300, {1, 1}, {0, 0}};
  g.channels = {"Y"};
  return g;
}

/// A frame without its pictures: they go as soon as the next one comes, as in a window.
struct Frame {
  bool error = false;
  int cells = 0, width_px = 0;
  bool coarse = false;
  double draw_s = 0, sum_s = 0, show_s = 0;
  Vec3 position_mm{0, 0, 0};
  Clock::time_point at;
};

/// The preview and what it handed out.
class Bench {
 public:
  Bench()
      : live({[this](std::shared_ptr<const PreviewFrame> frame) {
                note({false, frame->cells, frame->radiance->width_px, frame->coarse, frame->draw_s, frame->sum_s,
                      frame->show_s, frame->camera.position_mm, Clock::now()});
                shown_ = std::move(frame);
              },
              {},
              [this](const Error& error) {
                std::fprintf(stderr, "%s\n", error.message().c_str());
                note({.error = true, .at = Clock::now()});
              }}) {}
  /// The first frame after the last one looked at that is as wanted; an error ends the program.
  template <class Wanted>
  Frame next(Wanted&& wanted) {
    std::unique_lock lock(mutex_);
    while (true) {
      came_.wait(lock, [&] { return seen_ < frames_.size(); });
      const Frame frame = frames_[seen_++];
      if (frame.error) std::exit(1);
      if (wanted(frame)) return frame;
    }
  }
  std::vector<Frame> rest() {
    const std::lock_guard lock(mutex_);
    std::vector<Frame> left(frames_.begin() + static_cast<std::ptrdiff_t>(seen_), frames_.end());
    seen_ = frames_.size();
    return left;
  }

 private:
  void note(Frame frame) {
    const std::lock_guard lock(mutex_);
    frames_.push_back(std::move(frame));
    came_.notify_all();
  }
  std::mutex mutex_;
  std::condition_variable came_;
  std::vector<Frame> frames_;
  std::size_t seen_ = 0;
  std::shared_ptr<const PreviewFrame> shown_;

 public:
  LivePreview live;  ///< the last, so that it ends first
};

SceneCamera orbited(const SceneCamera& camera, double degrees) {
  const double angle = degrees * 3.14159265358979 / 180, c = std::cos(angle), s = std::sin(angle);
  SceneCamera moved = camera;
  const Vec3 from = camera.position_mm - camera.target_mm;
  moved.position_mm = camera.target_mm + Vec3(c * from.x() - s * from.y(), s * from.x() + c * from.y(), from.z());
  return moved;
}

/// One at a time, `apart` after the picture of the one before.
void add_cells(Bench& bench, const std::vector<std::shared_ptr<const CellImage>>& images,
               const LuminaireGeometry& geometry, std::chrono::milliseconds apart) {
  const Sampling& sampling = geometry.sampling;
  bench.live.set_luminaire(geometry);
  std::vector<double> total, sum, show;
  for (int k = 0; k < sampling.cells(); ++k) {
    std::this_thread::sleep_for(apart);
    const Clock::time_point start = Clock::now();
    bench.live.add(sampling.index(k), images[static_cast<std::size_t>(k)]);
    const Frame got = bench.next([&](const Frame& f) { return f.cells == k + 1 && !f.coarse; });
    if (k < 3) continue;  // kernels are compiled, times learned
    total.push_back(ms(got.at - start));
    sum.push_back(1e3 * got.sum_s);
    show.push_back(1e3 * got.show_s);
  }
  std::printf(
      "cell handed in to frame: median %.1f ms, p95 %.1f; of it summing %.1f and showing %.1f (medians), %.2f "
      "of the summing all in all\n",
      quantile(total, 0.5), quantile(total, 0.95), quantile(sum, 0.5), quantile(show, 0.5),
      quantile(total, 0.5) / quantile(sum, 0.5));
}

void change_views(Bench& bench, const SceneCamera& camera) {
  std::vector<double> coarse, full, draw;
  for (int k = 1; k <= 5; ++k) {
    const SceneCamera moved = orbited(camera, 7.0 * k);
    const auto of_view = [&](const Frame& f) { return f.position_mm == moved.position_mm; };
    const Clock::time_point start = Clock::now();
    bench.live.set_camera(moved, false);
    Frame got = bench.next(of_view);
    coarse.push_back(ms(got.at - start));
    if (got.coarse) got = bench.next([&](const Frame& f) { return of_view(f) && !f.coarse; });
    full.push_back(ms(got.at - start));
    draw.push_back(1e3 * got.draw_s);
  }
  std::printf(
      "another view: first picture after %.0f ms, full one after %.0f ms, of it drawing and handing over %.0f "
      "(medians of %zu)\n",
      quantile(coarse, 0.5), quantile(full, 0.5), quantile(draw, 0.5), full.size());
}

/// The camera moves 60 times a second for 6 s.
void orbit(Bench& bench, const SceneCamera& camera) {
  bench.rest();
  const Clock::time_point start = Clock::now();
  for (int k = 0; k < 360; ++k) {
    bench.live.set_camera(orbited(camera, 0.5 * k), true);
    std::this_thread::sleep_until(start + (k + 1) * std::chrono::microseconds(16667));
  }
  const std::vector<Frame> frames = bench.rest();
  std::vector<double> gaps, widths;
  int changes = 0;
  for (std::size_t k = 1; k < frames.size(); ++k) {
    gaps.push_back(ms(frames[k].at - frames[k - 1].at));
    widths.push_back(frames[k].width_px);
    changes += frames[k].width_px != frames[k - 1].width_px;
  }
  std::printf(
      "orbiting: %.1f pictures a second, %.0f ms from one to the next (median; p95 %.0f), %.0f pixels wide "
      "(median; %d changes)\n",
      1e3 * static_cast<double>(gaps.size()) / ms(frames.back().at - frames.front().at), quantile(gaps, 0.5),
      quantile(gaps, 0.95), quantile(widths, 0.5), changes);
}

bool measure(int width, int height) {
  const std::string root = LUMIFIELD_SOURCE_DIR;
  const auto scene = read_scene(root + "/resources/scenes/corner/scene.json");
  if (!scene) {
    std::fprintf(stderr, "%s\n", scene.error().message().c_str());
    return false;
  }
  const LuminaireGeometry geometry = bike_light();
  std::mt19937 random(1);
  std::uniform_real_distribution<float> value(0, 1);
  std::vector<std::shared_ptr<const CellImage>> images;
  for (int k = 0; k < geometry.sampling.cells(); ++k) {
    CellImage image{300, 300, 1, std::vector<float>(90000), {}, {}};
    for (float& v : image.value) v = value(random);
    images.push_back(std::make_shared<const CellImage>(std::move(image)));
  }
  Bench bench;
  bench.live.set_size(width, height);
  bench.live.set_scene(*scene);
  std::printf("%dx%d, %d cells\n", width, height, geometry.sampling.cells());
  add_cells(bench, images, geometry, std::chrono::milliseconds(60));
  change_views(bench, scene->camera);
  orbit(bench, scene->camera);
  bench.live.set_camera(scene->camera, false);
  bench.next([](const Frame& f) { return !f.coarse; });
  bench.live.set_scan_running(true);
  std::printf("with the scan running (the thread rests as long as it works):\n");
  add_cells(bench, images, geometry, std::chrono::milliseconds(400));
  orbit(bench, scene->camera);
  return true;
}

}  // namespace
}  // namespace lumifield

int main(int argc, char** argv) {
  const int width = argc > 2 ? std::atoi(argv[1]) : 1024, height = argc > 2 ? std::atoi(argv[2]) : 768;
  if (width < 1 || height < 1) return 2;
  return lumifield::measure(width, height) ? 0 : 1;
}
