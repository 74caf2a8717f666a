#include "app/session/bench_watch.h"

#include <chrono>
#include <condition_variable>
#include <mutex>

#include "acquisition/camera.h"
#include "acquisition/stage.h"
#include "app/session/device_names.h"
#include "app/session/guarded.h"

namespace lumifield {

namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

constexpr auto picture_every = 200ms;
constexpr auto try_again_after = 2s;

/// A device that is opened, used, and opened again after it failed. `Device` is Camera or Stage.
template <class Device>
struct Kept {
  std::unique_ptr<Device> device;
  Clock::time_point try_at{};

  template <class Open, class Show>
  bool ready(Open open, Show show) {
    if (device) return true;
    if (Clock::now() < try_at) return false;
    show({DeviceView::Link::opening, "", ""});
    Result<std::unique_ptr<Device>> opened = guarded("bench", open);
    if (!opened) {
      fail(opened.error(), show);
      return false;
    }
    device = std::move(*opened);
    show({DeviceView::Link::open, name_of(device->info()), ""});
    return true;
  }
  template <class Show>
  void fail(const Error& error, Show show) {
    device.reset();
    try_at = Clock::now() + try_again_after;
    show({DeviceView::Link::failed, "", error.message()});
  }
};

}  // namespace

BenchWatch::BenchWatch(std::optional<Bench> bench, double exposure_s, std::shared_ptr<BenchView> view,
                       std::unique_ptr<BenchWatch> before, BenchDevices devices)
    : bench_(std::move(bench)),
      exposure_s_(exposure_s),
      view_(std::move(view)),
      devices_(std::move(devices)),
      before_(std::move(before)),
      thread_([this](std::stop_token stop) { run(stop); }) {}

BenchWatch::~BenchWatch() = default;

void BenchWatch::run(std::stop_token stop) {
  before_.reset();
  if (!bench_) return;
  Kept<Camera> camera;
  Kept<Stage> stage;
  const auto show_camera = [this](DeviceView now) { view_->set_camera(std::move(now)); };
  const auto show_stage = [this](DeviceView now) { view_->set_stage(std::move(now)); };
  std::mutex mutex;
  std::condition_variable_any pause;
  while (!stop.stop_requested()) {
    const auto next = Clock::now() + picture_every;
    if (stage.ready([this] { return devices_.stage(bench_->stage); }, show_stage)) {
      const Result<Vec2> position = guarded("stage", [&] { return stage.device->position(); });
      if (position)
        view_->set_stage_mm(*position);
      else
        stage.fail(position.error(), show_stage);
    }
    if (!stop.stop_requested() && camera.ready([this] { return devices_.camera(bench_->camera); }, show_camera)) {
      const Status shown = guarded("camera", [&]() -> Status {
        Result<RawImage> frame = camera.device->expose(exposure_s_);
        if (!frame) return tl::unexpected(frame.error());
        auto bracket = std::make_shared<Bracket>();
        bracket->push_back(std::move(*frame));
        view_->set_bracket(std::move(bracket), "live");
        return {};
      });
      if (!shown) camera.fail(shown.error(), show_camera);
    }
    std::unique_lock lock(mutex);
    pause.wait_until(lock, stop, next, [] { return false; });
  }
  camera.device.reset();
  stage.device.reset();
  show_camera({});
  show_stage({});
}

}  // namespace lumifield
