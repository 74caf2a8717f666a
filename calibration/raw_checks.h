#pragma once

#include <optional>

#include "calibration/bracket_merge.h"
#include "luminaire/bench.h"
#include "luminaire/error.h"
#include "luminaire/light_field.h"
#include "luminaire/plan.h"
#include "luminaire/raw_image.h"

namespace lumifield {

/// Everything that must hold before a number is made. Each refusal names the thing at fault. Pure.

/// Pattern of a GenICam pixel format: Bayer formats by their two letters, RGGB of those with three colours a pixel, of
/// which one is taken (acquisition/cameras/pixel_layout.h), all else mono.
SensorPattern pattern_of(std::string_view pixel_format);

/// Sensor, camera model, planes, sizes and passes: finite, positive, within memory.
Status check_bench(const Bench& bench, const Plan& plan);

/// Size, pattern, exposures, gains; the passes as the bench has them; the dark set where there is one.
Status check_raw(const RawCell& raw, const Bench& bench, const LuminaireGeometry& geometry);
/// Every light exposure has its dark exposure.
Status check_dark_exposures(const RawPass& pass, const DarkModel& dark);

}  // namespace lumifield
