#pragma once

#include "luminaire/raw_image.h"

namespace lumifield {

/// What a frame says as a whole. Pure; frames are not empty.

/// Share of the pixels at or above `dn`, 0 … 1.
double share_from(const RawImage& frame, double dn);

/// Mean over the frame of DN − dark DN, and how sure it is.
struct FrameSignal {
  double dn = 0, standard_error_dn = 0;
};
/// Frames of one size.
FrameSignal mean_difference(const RawImage& lit, const RawImage& dark);

/// More than five standard errors above 0: not noise.
bool is_light(const FrameSignal& signal);

}  // namespace lumifield
