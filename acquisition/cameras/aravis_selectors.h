#pragma once

#include <functional>
#include <string>
#include <vector>

#include "luminaire/bench.h"
#include "luminaire/error.h"

typedef struct _ArvCamera ArvCamera;

namespace lumifield {

/// Features that stand in a GenICam camera once for each value of a selector, as Gain for GainSelector All and
/// DigitalAll: what is read or set is that of the value selected. Errors: a question or a value that is refused.
/// Source: EMVA GenICam Standard Features Naming Convention 2.7.

/// Whether the camera has it, and takes it under what is selected.
Result<bool> has_feature(ArvCamera* camera, const CameraSettings& settings, const char* feature);

/// What a selector offers; nothing where the camera lacks it.
Result<std::vector<std::string>> offered_values(ArvCamera* camera, const CameraSettings& settings,
                                                const char* selector);
Result<std::string> selected_value(ArvCamera* camera, const CameraSettings& settings, const char* selector);
/// Error also: another one is selected afterwards.
Status select_value(ArvCamera* camera, const CameraSettings& settings, const char* selector, const std::string& value);

/// " under SELECTOR VALUE".
std::string place_of(const char* selector, const std::string& value);

/// A step under every value that the selector offers, up to the first that fails, given its place_of; what was selected
/// before is selected again. One step, at no place, where there is no selector: null, or one that the camera lacks.
Status under_each(ArvCamera* camera, const CameraSettings& settings, const char* selector,
                  const std::function<Status(const std::string& place)>& step);

}  // namespace lumifield
