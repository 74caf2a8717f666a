#include "app/session/scan_recording.h"

#include <utility>

#include "luminaire/file_io.h"

namespace lumifield {

Result<std::shared_ptr<FrameRecording>> record_frames(ScanRequest& request, const std::filesystem::path& folder) {
  auto recording = FrameRecording::create(folder);
  if (!recording) return recording;
  std::error_code code;
  const std::filesystem::path place = std::filesystem::absolute(folder, code);
  if (code) return system_failure("could not be followed", folder, code.value());
  Bench played = request.bench;
  played.camera.kind = played.stage.kind = "replay";
  played.camera.address = played.stage.path = place.string();
  played.stage.check_home = false;
  request.devices.camera = [open = std::move(request.devices.camera), kept = *recording, json = to_json(played),
                            file = place /
                                   "bench.json"](const CameraSettings& settings) -> Result<std::unique_ptr<Camera>> {
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
