#pragma once

#include "luminaire/bench.h"
#include "luminaire/error.h"

typedef struct _ArvCamera ArvCamera;

namespace lumifield {

/// Switches off whatever a GenICam camera would change of the photosites' values by itself, or does with them on the
/// way: automatic exposure, gain, black level and white balance, exposures of another time than it is told, look-up
/// table, colour matrix, factors of colours (1), gamma (off, or 1). Those that it has are read back, under every value
/// of their selectors. Errors: one that stays on, as such frames are no measurement.
/// Source: EMVA GenICam Standard Features Naming Convention 2.7.
Status switch_automatics_off(ArvCamera* camera, const CameraSettings& settings);

/// The same of mirrored frames: first of all, as a camera may change its Bayer pattern with them.
Status switch_mirrors_off(ArvCamera* camera, const CameraSettings& settings);

}  // namespace lumifield
