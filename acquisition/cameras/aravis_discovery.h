#pragma once

#include <string>
#include <vector>

#include "acquisition/camera.h"

namespace lumifield {

/// Which GigE Vision cameras the network holds, and whether one may be opened. All functions block; otherwise
/// reentrant.

/// All cameras that answer a discovery, 1 s and 0.5 s for each that is out of reach.
std::vector<DeviceReport> find_aravis_cameras();

/// The camera at an address or of a name, by discovery or, in another subnet, by its address alone.
DeviceReport probe_aravis_camera(const CameraSettings& settings);

/// The IPv4 address behind a camera's id or serial number, 1 s; an address stands for itself.
Result<std::string> aravis_address(const std::string& name);

/// Waits until no other program controls the camera, as long as one that died would hold it. `name` is the bench
/// file's. Errors: none there, held by another program.
Status await_free(const std::string& ipv4_address, const std::string& name);

/// The Error of a camera that a living program holds.
tl::unexpected<Error> held_by_another(const std::string& name);

}  // namespace lumifield
