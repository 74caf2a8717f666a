#pragma once

#include <filesystem>
#include <memory>

#include "acquisition/cameras/recording_camera.h"
#include "app/session/scan_session.h"

namespace lumifield {

/// Lets a scan keep every frame that it takes in `folder`, which holds nothing yet, and a bench file, `bench.json`, in
/// which camera and stage are these frames: with it and the same plan the scan can be done again without a device. Of
/// the recording ask `error()` when the scan has ended: one that cannot go on ends by itself, the scan does not.
Result<std::shared_ptr<FrameRecording>> record_frames(ScanRequest& request, const std::filesystem::path& folder);

}  // namespace lumifield
