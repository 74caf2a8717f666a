#include "app/session/scan_recording.h"

#include <utility>

#include "app/session/precedent.h"
#include "luminaire/file_io.h"

namespace lumifield {
namespace {

namespace fs = std::filesystem;

constexpr const char* bench_name = "bench.json";

/// The bench that plays the frames back: it lies among them.
Bench played_bench(Bench bench) {
  bench.camera.kind = bench.stage.kind = "replay";
  bench.camera.address = bench.stage.path = ".";
  bench.stage.check_home = false;
  return bench;
}

Result<std::shared_ptr<FrameRecording>> begin_or_resume(const fs::path& folder, const Bench& played, bool resume) {
  std::error_code code;
  if (!resume || !fs::exists(folder / bench_name, code)) return FrameRecording::create(folder);
  const Result<Bench> begun = read_bench(folder / bench_name);
  if (!begun) return tl::unexpected(begun.error());
  if (begun->camera.kind != "replay") return FrameRecording::create(folder);  // it is another bench file
  if (Status same = check_same_bench(*begun, played); !same) return fail_in(folder.string(), same.error());
  return FrameRecording::resume(folder);
}

}  // namespace

Result<std::shared_ptr<FrameRecording>> record_frames(ScanRequest& request, const fs::path& folder) {
  const Bench played = played_bench(request.bench);
  auto recording = begin_or_resume(folder, played, request.resume);
  if (!recording) return recording;
  request.devices.camera = [open = std::move(request.devices.camera), kept = *recording, json = to_json(played),
                            file = folder /
                                   bench_name](const CameraSettings& settings) -> Result<std::unique_ptr<Camera>> {
    auto camera = open(settings);
    if (!camera) return camera;
    if (kept->frames() == 0)
      if (Status written = write_file_durably(file, json); !written) return tl::unexpected(written.error());
    return record(std::move(*camera), kept);
  };
  request.recording = *recording;
  return recording;
}

Notice end_of_recording(const FrameRecording& recording) {
  return {"the recording of the frames ends after " + std::to_string(recording.frames()) + ": " +
          recording.error()->message() + ". The scan goes on without it"};
}

}  // namespace lumifield
