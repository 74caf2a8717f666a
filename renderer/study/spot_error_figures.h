#pragma once

#include "renderer/study/study_bench.h"

namespace lumifield {

/// "Fig. 3": Er(θ0) for supports of 0.01, 0.04 and 0.1 δ, θ0 from 0 to 60°, along an axis of the support and across;
/// and the relative RMSE of the method against ClosedForm in double, in the light of one cell that sends a spot of
/// σ = 0.1 δ on S to θ0, of receivers 2 and 10 δ away, turned from it by 45°.
std::vector<FigureRow> constant_distance_figures();

}  // namespace lumifield
