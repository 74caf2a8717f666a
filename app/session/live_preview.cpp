#include "app/session/live_preview.h"

#include <atomic>
#include <condition_variable>
#include <mutex>
#include <sys/resource.h>
#include <thread>
#include <utility>

#include "app/session/guarded.h"
#include "app/session/preview_worker.h"

namespace lumifield {

namespace {

constexpr int niceness = 10;

}  // namespace

struct LivePreview::Impl {
  Impl(Callbacks callbacks, PreviewPace pace)
      : thread([this, callbacks = std::move(callbacks), pace](const std::stop_token& stop) {
          run(callbacks, pace, stop);
        }) {}

  /// What `change` does to the commands, the thread soon does.
  template <class Change>
  void command(Change&& change) {
    {
      const std::lock_guard lock(mutex);
      std::forward<Change>(change)(commands);
    }
    came.notify_one();
  }

  void run(const Callbacks& callbacks, PreviewPace pace, const std::stop_token& stop);
  bool wait(const PreviewWorker::Next& next, const std::stop_token& stop, PreviewCommands& taken);

  std::mutex mutex;
  std::condition_variable_any came;
  PreviewCommands commands;
  std::atomic<std::uint64_t> luminaire = 0;  ///< written under the mutex
  std::jthread thread;                       ///< the last, so that it ends before what it uses
};

/// False when the thread is to end.
bool LivePreview::Impl::wait(const PreviewWorker::Next& next, const std::stop_token& stop, PreviewCommands& taken) {
  std::unique_lock lock(mutex);
  came.wait_until(lock, stop, next.rest, [] { return false; });
  if (next.wake == PreviewWorker::Clock::time_point::max())
    came.wait(lock, stop, [&] { return commands.any(); });
  else
    came.wait_until(lock, stop, next.wake, [&] { return commands.any(); });
  taken = std::exchange(commands, {});
  return !stop.stop_requested();
}

void LivePreview::Impl::run(const Callbacks& callbacks, PreviewPace pace, const std::stop_token& stop) {
  // Of this thread alone, on Linux. One that may not yield works all the same.
  if (getpriority(PRIO_PROCESS, 0) < niceness) static_cast<void>(setpriority(PRIO_PROCESS, 0, niceness));
  PreviewWorker worker(callbacks, pace, stop);
  PreviewWorker::Next next;
  PreviewCommands taken;
  while (wait(next, stop, taken)) {
    const Status done = guarded("preview", [&]() -> Status {
      next = {};
      worker.take(std::exchange(taken, {}));
      if (!stop.stop_requested()) next = worker.step();
      return {};
    });
    if (done) continue;
    static_cast<void>(guarded("preview", [&]() -> Status {
      worker.give_up(done.error());
      return {};
    }));
  }
}

LivePreview::LivePreview(Callbacks callbacks, PreviewPace pace)
    : impl_(std::make_unique<Impl>(std::move(callbacks), pace)) {}
LivePreview::~LivePreview() = default;

void LivePreview::set_scene(Scene scene) {
  impl_->command([&](PreviewCommands& commands) {
    commands.scene = std::move(scene);
    commands.camera.reset();  // the scene's own counts until another comes, at rest
    commands.placements.reset();
    commands.moving.reset();
  });
}

void LivePreview::set_luminaire(LuminaireGeometry geometry) {
  impl_->command([&](PreviewCommands& commands) {
    commands.luminaire = {std::move(geometry), ++impl_->luminaire};
    commands.cells.clear();
  });
}

std::uint64_t LivePreview::luminaire() const { return impl_->luminaire; }

void LivePreview::add(CellIndex cell, std::shared_ptr<const CellImage> image, bool half) {
  impl_->command([&](PreviewCommands& commands) {
    if (impl_->luminaire > 0)
      commands.cells.push_back({cell, std::move(image), PreviewWorker::Clock::now(), half});
    else
      commands.refused.push_back(cell);
  });
}

void LivePreview::set_camera(const SceneCamera& camera, bool moving) {
  impl_->command([&](PreviewCommands& commands) {
    commands.camera = camera;
    commands.moving = moving;
  });
}

void LivePreview::set_placements(const std::vector<ScenePlacement>& placements, bool moving) {
  impl_->command([&](PreviewCommands& commands) {
    commands.placements = placements;
    commands.moving = moving;
  });
}

void LivePreview::set_visibility(Visibility visibility) {
  impl_->command([&](PreviewCommands& commands) { commands.visibility = visibility; });
}

void LivePreview::set_environment(bool on) {
  impl_->command([&](PreviewCommands& commands) { commands.environment = on; });
}

void LivePreview::refresh_shadows() {
  impl_->command([&](PreviewCommands& commands) { commands.refresh_shadows = true; });
}

void LivePreview::set_size(int width_px, int height_px) {
  impl_->command([&](PreviewCommands& commands) { commands.size_px = {width_px, height_px}; });
}

void LivePreview::set_method(const MethodSettings& method) {
  impl_->command([&](PreviewCommands& commands) { commands.method = method; });
}

void LivePreview::set_look(const PreviewLook& look) {
  impl_->command([&](PreviewCommands& commands) { commands.look = look; });
}

void LivePreview::set_scan_running(bool running) {
  impl_->command([&](PreviewCommands& commands) { commands.scan_running = running; });
}

}  // namespace lumifield
