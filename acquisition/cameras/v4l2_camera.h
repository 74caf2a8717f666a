#pragma once

#include <memory>
#include <vector>

#include "acquisition/camera.h"

namespace lumifield {

/// A camera behind a V4L2 device: USB cameras of the video class, CSI sensors. Opened by its path, /dev/video0 or a
/// link to it, of which those in /dev/v4l/by-id survive a change of ports.
///
/// Opening sets pixel format, size, gain and everything automatic off (v4l2_controls.h), reads it back, and starts the
/// stream, which runs until the end. The camera exposes on its own: of its frames one counts that surely began after it
/// was asked for and after its exposure time was set (v4l2_freshness.h). So a frame takes about two frame intervals and
/// read-out more than its exposure, and a change of the exposure three frames.
///
/// `exposure_s` goes in units of 100 µs. A camera whose frames follow each other faster than that is asked for a longer
/// frame interval, later for its own again where that saves time, and refused when it keeps the pace, as it then
/// exposes less than it says. Incomplete frames, and those that the driver lost while one was waited for, are counted;
/// of incomplete ones in a row six are too many. When no frame comes within the time of one + 300 ms (2 s after the
/// stream's start), the stream is started anew once. A camera that is gone stays so: destroy it and open it again.
Result<std::unique_ptr<Camera>> open_v4l2_camera(const CameraSettings& settings);

/// All of /dev/video* that capture pictures, with the formats that can be measured with. Nothing is changed in them.
std::vector<DeviceReport> find_v4l2_cameras();

DeviceReport probe_v4l2_camera(const CameraSettings& settings);

}  // namespace lumifield
