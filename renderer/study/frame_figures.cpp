#include "renderer/study/frame_figures.h"

#include <chrono>
#include <cmath>
#include <utility>

#include "renderer/methods/image_sampler_device.h"
#include "renderer/shading.h"
#include "renderer/study/ladder.h"

namespace lumifield {

namespace {

/// Of samples, so that they can be stopped; in pieces the closed form would compute its lobes once each.
constexpr double piece_s = 0.5;
const double none = std::nan("");

class Watch {
 public:
  /// Since it was made, or asked last.
  double lap_s() {
    const auto now = std::chrono::steady_clock::now();
    const std::chrono::duration<double> took = now - last_;
    last_ = now;
    return took.count();
  }

 private:
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

/// One frame, step by step; times in seconds.
class Frame {
 public:
  Frame(StudyCamera& camera, const StudyLuminaire& luminaire, const StudyProgress& progress)
      : camera_(camera), luminaire_(luminaire), light_field_(luminaire.light_field), progress_(progress) {}

  /// `moved_mm`: all luminaires along x of the scene, so that shadow maps are made for them.
  Status prepare(int width_px, int height_px, double moved_mm);
  /// Of a method that has nothing yet: kernel time. What it hands over and shows is in `times`, the kernel's is not.
  Result<double> light(DeviceMethod& method, double each_s);
  Result<double> step(SamplingSteps steps) {
    auto method = ImageSamplerDevice::create(light_field_.geometry(), {.method = Method::position_dependent}, steps);
    if (!method) return tl::unexpected(method.error());
    return light(**method, piece_s);
  }
  Result<double> closed_form(double lod) {
    auto method = make_device_method(light_field_.geometry(), {.method = Method::closed_form, .lod = lod});
    if (!method) return tl::unexpected(method.error());
    return light(**method, HUGE_VAL);
  }

  FrameTimes times;

 private:
  StudyCamera& camera_;
  const StudyLuminaire& luminaire_;
  const LightField& light_field_;
  const StudyProgress& progress_;
  GBuffer gbuffer_;
  std::vector<Receiver> receivers_;
  Appearance appearance_;
};

Status Frame::prepare(int width_px, int height_px, double moved_mm) {
  Scene scene = camera_.scene();
  for (ScenePlacement& each : scene.luminaires) each.pose(0, 3) += moved_mm;
  Watch watch;
  auto gbuffer = camera_.pass().draw(scene.camera, width_px, height_px);
  if (!gbuffer) return tl::unexpected(gbuffer.error());
  gbuffer_ = std::move(*gbuffer);
  times.gbuffer_s = watch.lap_s();
  const Receivers seen = receivers_of(gbuffer_, scene.luminaires);
  receivers_ = as_receivers(seen);
  appearance_.gloss = lobes_of(gbuffer_, camera_.materials(), scene.luminaires, scene.camera.position_mm);
  times.receivers_s = watch.lap_s();
  const Status there = camera_.shadows().see(scene.luminaires, light_field_.geometry(), Visibility::tile, false, seen.p,
                                             seen.face, appearance_);
  times.shadows_s = watch.lap_s();
  return there;
}

Result<double> Frame::light(DeviceMethod& method, double each_s) {
  if (const Status set = method.set_cells(light_field_); !set) return tl::unexpected(set.error());
  Watch watch;
  if (const Status set = method.set_receivers(receivers_, appearance_); !set) return tl::unexpected(set.error());
  times.hand_over_s = watch.lap_s();
  for (bool all = false; !all;) {
    if (!progress_(0, luminaire_.name + ", a whole frame")) return study_stopped();
    const auto done = method.evaluate(each_s);
    if (!done) return tl::unexpected(done.error());
    all = *done;
  }
  watch.lap_s();
  std::vector<double> irradiance, gloss;
  if (const Status read = method.read(irradiance); !read) return tl::unexpected(read.error());
  if (const Status read = method.read_gloss(gloss); !read) return tl::unexpected(read.error());
  Picture picture{gbuffer_.width_px,
                  gbuffer_.height_px,
                  std::vector<float>(3 * gbuffer_.position.size() / 4),
                  std::vector<float>(gbuffer_.position.size() / 4),
                  {}};
  shade(gbuffer_, camera_.materials(), camera_.scene().luminaires,
        {irradiance, light_field_.geometry().channels.size(), gloss, method.gloss_channels()}, {}, picture);
  tone_map(picture, {});
  times.show_s = watch.lap_s();
  return method.kernel_s();
}

constexpr const char* figure = "Fig. 10";
constexpr const char* rate = "frames/s";

}  // namespace

std::vector<FigureRow> frame_rows(const FrameTimes& times, const std::string& luminaire, const std::string& size) {
  std::vector<FigureRow> rows;
  const auto share = [&](const char* what, double s, double paper) {
    rows.push_back(
        {figure, luminaire, size + what, "share of the frame, K = 200, %", 100 * s / times.frame_s(), paper});
  };
  share("the balance A_m", times.balance_s, 5.3);
  share("drawing samples", times.drawn_s - times.balance_s, 33.6);
  share("weighing and summing them (paper: shading)", times.kernel_s - times.drawn_s, 31.9);
  share("reading the sums, shading, tone mapping (paper: accumulation)", times.show_s, 16.2);
  share("shadows: maps and tests", times.shadows_s, 9.2);
  share("G-buffer, receivers, handing over (paper: other)", times.gbuffer_s + times.receivers_s + times.hand_over_s,
        3.8);
  rows.push_back({figure, luminaire, size + "position-dependent, K = 200", rate, 1 / times.frame_s(), 9});
  return rows;
}

Result<std::vector<FigureRow>> frame_figures(StudyCamera& camera, const StudyLuminaire& luminaire, bool quick,
                                             const StudyProgress& progress) {
  const int width = quick ? 256 : 1024, height = quick ? 192 : 768;
  Frame frame(camera, luminaire, progress);
  // The first frame compiles what is compiled once.
  for (const double moved_mm : {1.0, 0.0})
    if (const Status prepared = frame.prepare(width, height, moved_mm); !prepared)
      return tl::unexpected(prepared.error());
  for (const auto& [steps, took_s] : {std::pair(SamplingSteps::balance, &frame.times.balance_s),
                                      {SamplingSteps::draws, &frame.times.drawn_s},
                                      {SamplingSteps::all, &frame.times.kernel_s}}) {
    const auto took = frame.step(steps);
    if (!took) return tl::unexpected(took.error());
    *took_s = *took;
  }
  const std::size_t count = camera.scene().luminaires.size();
  const std::string size = std::to_string(width) + "x" + std::to_string(height) + ", " + std::to_string(count) +
                           (count == 1 ? " luminaire: " : " luminaires: ");
  std::vector<FigureRow> rows = frame_rows(frame.times, luminaire.name, size);
  for (const double lod : {0.0, 8.0}) {
    const auto took = frame.closed_form(lod);
    if (!took) return tl::unexpected(took.error());
    rows.push_back({figure, luminaire.name, size + (lod == 0 ? "closed-form, exact" : "closed-form, T = 8"), rate,
                    1 / (frame.times.host_s() + *took), none});
  }
  return rows;
}

}  // namespace lumifield
