#pragma once

#include <cstddef>
#include <vector>

#include "luminaire/bench.h"
#include "luminaire/plan.h"
#include "luminaire/raw_image.h"

namespace lumifield {

/// The exposures that a scan may take: the plan's, and beyond their ends those in their own ratio (of the first two, of
/// the last two; 4 where there is one) that lie within plan.exposure_limits_s. Value type.
struct ExposureLadder {
  std::vector<double> exposures_s;           ///< ascending; at most one more than most_exposures
  std::size_t plan_begin = 0, plan_end = 0;  ///< half-open: the plan's among them

  std::size_t size() const { return exposures_s.size(); }
};
ExposureLadder exposure_ladder(const Plan& plan);

/// When to go beyond the plan's exposures; the shares are of all pixels of the frame, whatever they see. Pure.

/// More than `share` of the pixels are at or above saturation: a shorter exposure is needed.
bool is_saturated(const RawImage& frame, const Sensor& sensor, double share);

/// An exposure `ratio` times as long is worth its time: no more than `share` of the pixels would reach saturation,
/// those at or above (saturation − black)/ratio + black, and the frame has light in it: it stands above its dark frame
/// as is_light says. False where the dark frame has another size, which whoever develops the frame refuses.
bool may_be_longer(const RawImage& frame, const RawImage& dark, double ratio, const Sensor& sensor, double share);

}  // namespace lumifield
