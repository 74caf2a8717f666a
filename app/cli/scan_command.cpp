#include <csignal>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <thread>

#include "app/cli/commands.h"
#include "app/cli/scan_report.h"
#include "app/session/scan_session.h"
#include "luminaire/bench.h"
#include "luminaire/plan.h"
#include "luminaire/scene.h"

namespace lumifield {

namespace {

/// Turns SIGINT and SIGTERM into a stop of the session. The signals are blocked in every thread and taken by one.
class StopOnSignal {
 public:
  StopOnSignal() {
    sigemptyset(&signals_);
    sigaddset(&signals_, SIGINT);
    sigaddset(&signals_, SIGTERM);
    pthread_sigmask(SIG_BLOCK, &signals_, nullptr);
  }
  void watch(ScanSession& session) {
    thread_ = std::jthread([this, &session](std::stop_token stop) {
      const timespec tick{0, 100'000'000};
      while (!stop.stop_requested())
        if (sigtimedwait(&signals_, nullptr, &tick) > 0) session.stop();
    });
  }
  void end() { thread_ = {}; }

 private:
  sigset_t signals_;
  std::jthread thread_;
};

Result<ScanRequest> make_request(const ScanOptions& options) {
  ScanRequest request;
  auto bench = read_bench(options.bench);
  if (!bench) return tl::unexpected(bench.error());
  auto plan = read_plan(options.plan);
  if (!plan) return tl::unexpected(plan.error());
  const auto size = parse_size(options.size);
  if (!size) return tl::unexpected(size.error());
  request.bench = std::move(*bench);
  request.plan = std::move(*plan);
  request.out = options.out;
  if (!request.out.has_filename()) request.out = request.out.parent_path();
  request.resume = options.resume;
  std::tie(request.preview_width_px, request.preview_height_px) = *size;
  if (!options.preview.empty()) {
    auto scene = read_scene(options.preview);
    if (!scene) return tl::unexpected(scene.error());
    request.preview = std::move(*scene);
    request.picture_shares = {0.05, 0.5, 1};
  }
  return request;
}

/// NAME_005.png and the linear NAME_005.exr.
Status write_pictures(const PictureMade& made, const std::filesystem::path& folder, const std::string& name,
                      double exposure) {
  char share[8];
  std::snprintf(share, sizeof share, "_%03.0f", 100 * made.share);
  const std::filesystem::path stem = folder / (name + share);
  if (Status png = write_png(tone_map(made.picture, {exposure, 0}), stem.string() + ".png"); !png) return png;
  return write_exr(made.picture, stem.string() + ".exr");
}

}  // namespace

int run_scan(const ScanOptions& options) {
  auto request = make_request(options);
  if (!request) return report_error(request.error(), options.json);
  const std::filesystem::path out = request->out;
  const std::filesystem::path pictures =
      options.pictures.empty() ? out.parent_path() : std::filesystem::path(options.pictures);

  StopOnSignal signals;
  auto session = ScanSession::start(std::move(*request));
  if (!session) return report_error(session.error(), options.json);
  signals.watch(**session);

  ProgressLine line;
  std::optional<Error> picture_error;
  while (auto event = (*session)->next_event()) {
    if (const auto* progress = std::get_if<ScanProgress>(&*event)) line.show(*progress);
    if (const auto* notice = std::get_if<Notice>(&*event)) line.say(notice->text);
    if (const auto* made = std::get_if<PictureMade>(&*event)) {
      line.say("picture with " + std::to_string(made->cells) + " cells; " + made->picture.note);
      if (Status written = write_pictures(*made, pictures, out.stem().string(), options.exposure); !written)
        picture_error = written.error();
    }
  }
  line.end();
  signals.end();

  auto summary = (*session)->wait();
  if (!summary) {
    report_error(summary.error(), options.json);
    return summary.error().what == stopped_by_operator ? exit_stopped : exit_failed;
  }
  std::fputs((options.json ? summary_json(*summary) + "\n" : summary_text(*summary)).c_str(), stdout);
  if (picture_error) return report_error(*picture_error, false);
  return exit_done;
}

}  // namespace lumifield
