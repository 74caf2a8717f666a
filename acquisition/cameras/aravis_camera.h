#pragma once

#include <memory>

#include "acquisition/camera.h"

namespace lumifield {

/// A GigE Vision camera through Aravis. Opened by its IPv4 address; a name (id or serial) is looked up first, 1 s.
///
/// Opening applies pixel format, full region, gain, automatic exposure and gain off, software trigger, and reads them
/// back; then the stream runs until the end, one trigger a frame. The stream packet is `packet_bytes`, or the largest
/// the camera and the network take. A camera that another program holds is waited for once for 3.5 s: that long it
/// stays held after a program died.
///
/// A frame counts when it is complete, of the right format and size, and newer than the trigger. An incomplete one is
/// taken again, five times at most. When nothing comes within the exposure + readout + 300 ms, the camera is asked
/// whether it lives: then the trigger was lost and is sent once more, else the camera is gone. So is one that restarted
/// or that another program took over. A camera that is gone stays so: destroy it and open it again. Destroying it may
/// take 7 s.
Result<std::unique_ptr<Camera>> open_aravis_camera(const CameraSettings& settings);

}  // namespace lumifield
