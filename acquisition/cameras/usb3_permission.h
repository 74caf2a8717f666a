#pragma once

#include <filesystem>
#include <vector>

#include "acquisition/camera.h"

namespace lumifield {

/// USB3 Vision cameras that are plugged in and that this user may not open, which no discovery lists: devices with an
/// interface of class EF, subclass 05, told by sysfs. Nothing is opened. Reentrant.
std::vector<DeviceReport> usb3_cameras_without_permission(const std::filesystem::path& sysfs = "/sys/bus/usb/devices",
                                                          const std::filesystem::path& nodes = "/dev/bus/usb");

}  // namespace lumifield
