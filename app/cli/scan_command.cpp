#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <unistd.h>

#include "app/cli/commands.h"
#include "app/cli/noted_files.h"
#include "app/cli/scan_report.h"
#include "app/cli/stop_on_signal.h"
#include "app/session/scan_recording.h"
#include "app/session/scan_session.h"
#include "luminaire/bench.h"
#include "luminaire/plan.h"
#include "luminaire/scene.h"

namespace lumifield {

namespace {

/// The folder for the pictures, made when it is not there, before anything moves.
Status prepare_folder(const std::filesystem::path& folder) {
  std::error_code wrong;
  std::filesystem::create_directories(folder, wrong);
  if (!wrong && access(folder.c_str(), W_OK) != 0) wrong = std::error_code(errno, std::generic_category());
  if (wrong)
    return fail("pictures cannot be written there: " + wrong.message(), folder.string(),
                "name another folder with --pictures");
  return {};
}

Result<ScanRequest> make_request(const ScanOptions& options) {
  ScanRequest request;
  std::vector<std::string> notes;
  auto bench = read_bench(options.bench, &notes, ReaderNotes::ignored);
  if (!bench) return tl::unexpected(bench.error());
  auto plan = read_plan(options.plan, &notes, ReaderNotes::ignored);
  if (!plan) return tl::unexpected(plan.error());
  for (const std::string& note : notes) print_note(note);
  const auto size = parse_size(options.size);
  if (!size) return tl::unexpected(size.error());
  request.bench = std::move(*bench);
  request.plan = std::move(*plan);
  request.out = options.out;
  if (!request.out.has_filename()) request.out = request.out.parent_path();
  request.resume = options.resume;
  request.accept_drift = options.accept_drift;
  std::tie(request.preview_width_px, request.preview_height_px) = *size;
  if (!options.preview.empty()) {
    auto scene = read_noted_scene(options.preview);
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

/// The operator changes the slide: what is measured of some cells is one pass alone.
std::string half_cells_text(int cells) {
  return cells > 0 ? ", " + std::to_string(cells) + " of them with the first pass alone: the others' light is missing"
                   : "";
}

}  // namespace

int run_scan(const ScanOptions& options) {
  auto request = make_request(options);
  if (!request) return report_error(request.error(), options.json);
  const std::filesystem::path out = request->out;
  const bool homes = request->bench.stage.home;
  const std::filesystem::path pictures = !options.pictures.empty() ? std::filesystem::path(options.pictures)
                                         : out.has_parent_path()   ? out.parent_path()
                                                                   : ".";

  if (request->preview)
    if (Status prepared = prepare_folder(pictures); !prepared) return report_error(prepared.error(), options.json);

  std::shared_ptr<FrameRecording> recording;
  if (!options.record.empty()) {
    auto made = record_frames(*request, options.record);
    if (!made) return report_error(made.error(), options.json);
    recording = std::move(*made);
  }

  const sigset_t signals = StopOnSignal::block();
  auto session = ScanSession::start(std::move(*request));
  if (!session) return report_error(session.error(), options.json);
  std::optional<StopOnSignal> watcher(std::in_place, signals, [&session] { (*session)->stop(); });

  ProgressLine line;
  std::optional<Error> picture_error;
  while (auto event = (*session)->next_event()) {
    if (const auto* scan = std::get_if<ScanPrediction>(&*event)) line.say("the scan: " + prediction_line(*scan));
    if (const auto* progress = std::get_if<ScanProgress>(&*event)) line.show(*progress);
    if (const auto* notice = std::get_if<Notice>(&*event)) line.say(notice->text);
    if (const auto* made = std::get_if<PictureMade>(&*event)) {
      line.say("picture with " + std::to_string(made->cells) + " cells" + half_cells_text(made->half_cells));
      if (Status written = write_pictures(*made, pictures, out.stem().string(), options.exposure); !written) {
        line.say("lumifield: " + written.error().message());
        picture_error = written.error();
      }
    }
  }
  watcher.reset();

  auto summary = (*session)->wait();
  if (recording) line.say(std::to_string(recording->frames()) + " frames are recorded in " + options.record);
  const bool recording_failed = recording && recording->error();
  if (recording_failed) line.say("lumifield: the recording ended early: " + recording->error()->message());
  if (!summary) {
    line.end();
    return report_error(summary.error(), options.json, go_on_text((*session)->kept(), summary.error(), homes));
  }
  line.done(*summary);
  std::fputs((options.json ? summary_json(*summary) + "\n" : summary_text(*summary)).c_str(), stdout);
  return picture_error || recording_failed ? exit_failed : exit_done;
}

}  // namespace lumifield
