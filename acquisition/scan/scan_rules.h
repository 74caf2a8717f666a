#pragma once

#include <vector>

#include "acquisition/scan/scan_plan.h"
#include "luminaire/bench.h"
#include "luminaire/error.h"
#include "luminaire/plan.h"

namespace lumifield {

/// What a plan and a bench must keep for every measured cell to be complete and free of another filter's light. The
/// lamp is centred on u = 0 and lamp_size_mm wide; only where the slide has a filter or a hole does light pass.
/// Reentrant.

/// The grid on U that plan and bench make.
Sampling sampling_of(const Bench& bench, const Plan& plan);

/// Columns and rows that it takes so that every cell whose dual window (Goesele et al. 2003) touches the lamp is in the
/// grid: beyond the last one, C is 0 everywhere. ⌈(lamp + window·a + 2·abs(center))/a⌉ − 1 per axis.
struct GridSize {
  double columns = 0, rows = 0;
};
GridSize needed_grid(const Bench& bench, const Plan& plan);

/// That the kinds of camera and stage are known, and that the limits lie within the travel that the bench file tells.
Status check_devices(const Bench& bench);

/// Everything but the stage's limits and what the devices are.
Status check_rules(const Bench& bench, const Plan& plan);

/// Every target of the steps, and where it is approached from, against bench.limits.
Status check_limits(const Bench& bench, const std::vector<ScanStep>& steps);

}  // namespace lumifield
