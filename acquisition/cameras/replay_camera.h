#pragma once

#include <memory>
#include <vector>

#include "acquisition/camera.h"

namespace lumifield {

/// A folder of frames (frame_folder.h) as a camera; its address is the folder. No device: frames come at once, however
/// long they were exposed.
///
/// Opening reads the list and every picture's header: all are of one size, and of the bits and the pattern of the bench
/// file's pixel format; its gain is that of the frames where they tell one. An exposure is given to the frame that was
/// asked for the same, within 0.1 %.
///
/// In a scan, which tells where the stage stands, the n-th exposure at a place is answered by the n-th frame that was
/// taken within CameraSettings::same_place_mm of it with that exposure, and by the last of them ever after: in whatever
/// order cells come, a scan is played back as it was, gone on with, tried (`rehearse`) or taken anew in part. A scan
/// that had to go back to cells is played back as if it had not: what was exposed first counts. A place or an exposure
/// that is not listed is refused, and so is a picture that is gone or damaged since: for good (ErrorKind::refused).
///
/// A list without places answers a scan in its order, each frame once; another exposure than the next frame's is
/// refused, and so is one beyond the last. Exposures outside of scans, whose place is not told, are answered by the
/// frames with that exposure, round and round.
Result<std::unique_ptr<Camera>> open_replay_camera(const CameraSettings& settings);

/// None: a folder does not answer.
std::vector<DeviceReport> find_replay_cameras();

DeviceReport probe_replay_camera(const CameraSettings& settings);

}  // namespace lumifield
