#include "renderer/study/frame_figures.h"

#include <chrono>
#include <cmath>

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
  /// Of a method that has nothing yet: kernel time. What it hands over and shows is in `hand_over_s` and `show_s`.
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

  double gbuffer_s = 0, receivers_s = 0, shadows_s = 0, hand_over_s = 0, show_s = 0;
  double host_s() const { return gbuffer_s + receivers_s + shadows_s + hand_over_s + show_s; }

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
  gbuffer_s = watch.lap_s();
  const Receivers seen = receivers_of(gbuffer_, scene.luminaires);
  receivers_ = as_receivers(seen);
  appearance_.gloss = lobes_of(gbuffer_, camera_.materials(), scene.luminaires, scene.camera.position_mm);
  receivers_s = watch.lap_s();
  const Status there = camera_.shadows().see(scene.luminaires, light_field_.geometry(), Visibility::tile, false, seen.p,
                                             seen.face, appearance_);
  shadows_s = watch.lap_s();
  return there;
}

Result<double> Frame::light(DeviceMethod& method, double each_s) {
  if (const Status set = method.set_cells(light_field_); !set) return tl::unexpected(set.error());
  Watch watch;
  if (const Status set = method.set_receivers(receivers_, appearance_); !set) return tl::unexpected(set.error());
  hand_over_s = watch.lap_s();
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
  show_s = watch.lap_s();
  return method.kernel_s();
}

}  // namespace

Result<std::vector<FigureRow>> frame_figures(StudyCamera& camera, const StudyLuminaire& luminaire, bool quick,
                                             const StudyProgress& progress) {
  const int width = quick ? 256 : 1024, height = quick ? 192 : 768;
  Frame frame(camera, luminaire, progress);
  // The first frame compiles what is compiled once.
  for (const double moved_mm : {1.0, 0.0})
    if (const Status prepared = frame.prepare(width, height, moved_mm); !prepared)
      return tl::unexpected(prepared.error());
  const auto balance = frame.step(SamplingSteps::balance);
  const auto drawn = balance.and_then([&](double) { return frame.step(SamplingSteps::draws); });
  const auto kernel = drawn.and_then([&](double) { return frame.step(SamplingSteps::all); });
  if (!kernel) return tl::unexpected(kernel.error());
  const double sampled_s = frame.host_s() + *kernel;

  std::vector<FigureRow> rows;
  const std::size_t count = camera.scene().luminaires.size();
  const std::string size = std::to_string(width) + "x" + std::to_string(height) + ", " + std::to_string(count) +
                           (count == 1 ? " luminaire: " : " luminaires: ");
  const auto add = [&](const std::string& what, const char* quantity, double ours, double paper) {
    rows.push_back({"Fig. 10", luminaire.name, size + what, quantity, ours, paper});
  };
  const auto share = [&](const char* what, double s, double paper) {
    add(what, "share of the frame, K = 200, %", 100 * s / sampled_s, paper);
  };
  share("the balance A_m", *balance, 5.3);
  share("drawing samples", *drawn - *balance, 33.6);
  share("weighing and summing them (paper: shading)", *kernel - *drawn, 31.9);
  share("reading the sums, shading, tone mapping (paper: accumulation)", frame.show_s, 16.2);
  share("shadows: maps and tests", frame.shadows_s, 9.2);
  share("G-buffer, receivers, handing over (paper: other)", frame.gbuffer_s + frame.receivers_s + frame.hand_over_s,
        3.8);
  constexpr const char* rate = "frames/s";
  add("position-dependent, K = 200", rate, 1 / sampled_s, 9);
  for (const double lod : {0.0, 8.0}) {
    const auto took = frame.closed_form(lod);
    if (!took) return tl::unexpected(took.error());
    add(lod == 0 ? "closed-form, exact" : "closed-form, T = 8", rate, 1 / (frame.host_s() + *took), none);
  }
  return rows;
}

}  // namespace lumifield
