#pragma once

#include <string>

#include "luminaire/bench.h"
#include "luminaire/error.h"

typedef struct _ArvCamera ArvCamera;

namespace lumifield {

/// The gain under the value of GainSelector that is selected, as the camera tells it. Value type.
struct AravisGain {
  bool is_there = false;
  /// Else it counts in a unit of the camera's own: a factor, steps.
  bool is_db = false;
  double low = 0, high = 0;

  /// What it counts in, as it stands behind a number: " dB".
  std::string unit() const { return is_db ? " dB" : ""; }
  /// Of a gain that adds nothing: 0 dB; else a factor of 1, where 0 is none; else the least there is, which is the same
  /// every time.
  double neutral() const;
};
Result<AravisGain> aravis_gain(ArvCamera* camera, const CameraSettings& settings);

/// Sets the gain that is measured with, and reads it back: that of GainSelector All, else AnalogAll, else DigitalAll,
/// else of its only value. All others become neutral; of a camera that has but gains of parts (taps, colours), every
/// one. The result in dB; 0 of one that counts otherwise, where `gain` is the number that it counts and
/// Sensor::gain_dn_per_e holds with it. Errors: a gain out of its range, one taken otherwise, one of a part.
Result<double> set_aravis_gain(ArvCamera* camera, const CameraSettings& settings);

}  // namespace lumifield
