#pragma once

#include <memory>

#include "acquisition/camera.h"

namespace lumifield {

/// A GenICam camera through Aravis: GigE Vision, or USB3 Vision. A GigE Vision camera is opened by its IPv4 address; a
/// name (id or serial) is looked up first, 1 s, and a name that several have is refused with the list of them. One on
/// USB is opened by its id. Shown on simulated cameras: GigE Vision over sockets, USB3 Vision over libusb, and Aravis'
/// camera in process; on no maker's.
///
/// Opening applies pixel format, binning, full region, gain, software trigger, everything automatic and every gamma off
/// (aravis_automatics.h), and reads them back; then the stream runs until the end, one trigger a frame. Formats are
/// those of pixel_layout.h, packed ones and RGB8 among them; YUV and the like are refused. GigE Vision packets are
/// `packet_bytes`, or the largest the camera and the network take, or found by test frames (aravis_packets.h), which
/// `info().found` tells. A GigE Vision camera that another program holds is waited for once for 3.5 s: that long it
/// stays held after a program died.
///
/// A frame counts when it is complete, of the right format and size, and newer than the trigger. An incomplete one is
/// taken again, five times at most. When nothing comes within the exposure + readout + 300 ms, the camera is asked
/// whether it lives: then the trigger was lost and is sent once more, else the camera is gone. So is one that restarted
/// or that another program took over. A camera that is gone stays so: destroy it and open it again. Destroying it may
/// take 7 s.
Result<std::unique_ptr<Camera>> open_aravis_camera(const CameraSettings& settings);

}  // namespace lumifield
