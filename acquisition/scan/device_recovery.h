#pragma once

#include "acquisition/camera.h"
#include "acquisition/stage.h"

namespace lumifield {

/// Camera and stage of a scan, and how they are opened again. Thread-bound to the bench thread.
class DeviceRecovery {
 public:
  virtual ~DeviceRecovery() = default;

  /// The devices in use. Those that could not be opened again refuse everything.
  virtual Camera& camera() = 0;
  virtual Stage& stage() = 0;

  /// Lets go of the device and opens it anew, its settings applied and verified. Errors: those of opening it.
  virtual Status reopen_camera() = 0;
  virtual Status reopen_stage() = 0;
};

}  // namespace lumifield
