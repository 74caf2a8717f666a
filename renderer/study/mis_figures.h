#pragma once

#include "renderer/study/study_bench.h"

namespace lumifield {

/// mis beside its two parts, position-dependent and filtered-brdf, at equal kernel time: that of mis with its usual K.
/// Per roughness of a GGX lobe with F0 = common_f0 on every surface, and diffuse: what is seen of up to 1,024 receivers
/// of the scene, unshadowed, its relative RMSE over a few seeds by each, and that of mis over the better of the others;
/// once as the scene is seen, and for lobes again by eyes that each see the lamp mirrored. The parts' ladders go on
/// until two points hold the time of mis between them, or K is 1 or 256 times the usual; what is beyond says so.
/// Errors: those of StudyCamera::frame and of the methods, stopped.
Result<std::vector<FigureRow>> mis_figures(StudyCamera& camera, const StudyLuminaire& luminaire,
                                           const std::filesystem::path& cache, bool quick,
                                           const StudyProgress& progress);

}  // namespace lumifield
