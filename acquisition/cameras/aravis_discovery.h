#pragma once

#include <string>
#include <vector>

#include "acquisition/camera.h"

namespace lumifield {

/// Which cameras Aravis finds, GigE Vision and USB3 Vision, and whether one may be opened. All functions block;
/// otherwise reentrant.

/// All cameras that answer a discovery, 1 s and 0.5 s for each that is out of reach. Those that nobody holds are opened
/// for a moment, to ask what they can.
std::vector<DeviceReport> find_aravis_cameras();

/// The camera at an address or of a name, by discovery or, in another subnet, by its address alone.
DeviceReport probe_aravis_camera(const CameraSettings& settings);

/// How a camera is reached.
struct AravisAddress {
  std::string name;  ///< for Aravis: an IPv4 address, or an id
  std::string ipv4;  ///< of a GigE Vision camera; empty: of another, which has no network
};

/// Where the camera with this id or serial number is, 1 s, 2 s to find none; an IPv4 address stands for itself. A GigE
/// Vision camera is then opened by its address: opened by its id, Aravis may reach it through another network card than
/// its stream. Of cameras with one id, which no two should have, Aravis lists one: name such by address. Errors: none
/// there, several.
Result<AravisAddress> aravis_address(const std::string& name);

/// Waits until no other program controls the camera, as long as one that died would hold it. `name` is the bench
/// file's. Errors: none there, held by another program.
Status await_free(const std::string& ipv4_address, const std::string& name);

/// The Error of a camera that a living program holds.
tl::unexpected<Error> held_by_another(const std::string& name);

}  // namespace lumifield
