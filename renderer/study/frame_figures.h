#pragma once

#include "renderer/study/study_bench.h"

namespace lumifield {

/// What one frame of the scene costs with all its luminaires, glossy as it is and in shadow, and what of it each step
/// takes: position-dependent at K = 200, beside Lu, Pacanowski, Granier 2015, Fig. 10 (two car2 headlights, 1024×768,
/// a GTX 580: 9 frames/s), and the closed form. Steps on the host by the clock, kernels by the device's profiling.
/// 1024×768, 256×192 if quick. Errors: no OpenCL, the scene's, stopped.
Result<std::vector<FigureRow>> frame_figures(StudyCamera& camera, const StudyLuminaire& luminaire, bool quick,
                                             const StudyProgress& progress);

}  // namespace lumifield
