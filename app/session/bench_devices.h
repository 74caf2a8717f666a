#pragma once

#include <functional>
#include <memory>

#include "acquisition/camera.h"
#include "acquisition/stage.h"

namespace lumifield {

/// How camera and stage of a bench are opened: as its file names them, unless otherwise given. Called on the thread
/// that uses the device. Value type.
struct BenchDevices {
  std::function<Result<std::unique_ptr<Camera>>(const CameraSettings&)> camera = open_camera;
  std::function<Result<std::unique_ptr<Stage>>(const StageSettings&)> stage = open_stage;
};

}  // namespace lumifield
