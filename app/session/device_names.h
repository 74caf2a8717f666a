#pragma once

#include <string>

#include "acquisition/camera.h"
#include "acquisition/stage.h"

namespace lumifield {

/// Devices as records and windows name them.
inline std::string name_of(const CameraInfo& info) {
  return info.vendor + " " + info.model + " " + info.serial + " at " + info.address +
         (info.found.empty() ? "" : ", found " + info.found);
}
inline std::string name_of(const StageInfo& info) { return info.firmware + " at " + info.path; }

}  // namespace lumifield
