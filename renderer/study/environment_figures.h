#pragma once

#include <vector>

#include "renderer/environment/lat_long.h"
#include "renderer/study/study_bench.h"

namespace lumifield {

/// Fig. 20-8 and 20-9 of GPU Gems 3, ch. 20 on our environment: a smooth sphere, seen from far away, that reflects it
/// by Phong's lobe of exponent 50 and by GGX's of roughness 0.3, at 10 … 200 samples with and without a filter: mean
/// Lab ΔE against 10⁵ unfiltered samples, relative RMSE, the filter's bias as that of the mean over 64 seeds, and the
/// time of the picture. Errors: stopped.
Result<std::vector<FigureRow>> environment_figures(const LatLong& environment, const StudyProgress& progress);

}  // namespace lumifield
