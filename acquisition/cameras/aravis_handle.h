#pragma once

#include <memory>
#include <string>

#include "acquisition/cameras/aravis_discovery.h"
#include "luminaire/error.h"

typedef struct _ArvCamera ArvCamera;

namespace lumifield {

struct ReleaseCamera {
  void operator()(ArvCamera* camera) const;
};
using CameraHandle = std::unique_ptr<ArvCamera, ReleaseCamera>;

/// Takes control of the camera, of which nothing is set yet. `name` is the bench file's. Blocks for as long as its
/// description takes to load. Errors: held by another program, no answer, not the kind of camera that was found there.
Result<CameraHandle> take_control(const AravisAddress& at, const std::string& name);

/// What an open camera can do, in words: the pixel formats that are measured with, its sensor's size, exposure times,
/// gain, binning, as far as it tells. Only asks. Errors: none of its formats, or its formats or gain cannot be read.
Result<std::string> capabilities_of(ArvCamera* camera, const std::string& name);

}  // namespace lumifield
