#pragma once

#include <filesystem>
#include <memory>

#include "acquisition/cameras/recording_camera.h"
#include "app/session/scan_session.h"

namespace lumifield {

/// Lets a scan keep every frame that it takes in `folder`, which holds nothing yet, and a bench file, `bench.json`, in
/// which camera and stage are these frames, by their own folder: with it and the same plan the scan can be done again
/// without a device, wherever the folder is moved. A scan that is resumed goes on with the recording that its bench
/// began there. Errors: a folder that holds something else, or a recording of another bench. A recording that cannot go
/// on ends by itself, the scan does not: a notice tells at once, `error()` of the recording when the scan has ended.
Result<std::shared_ptr<FrameRecording>> record_frames(ScanRequest& request, const std::filesystem::path& folder);

/// What the operator is told when it ends, and not hours later with the scan; it has an `error()`.
Notice end_of_recording(const FrameRecording& recording);

}  // namespace lumifield
