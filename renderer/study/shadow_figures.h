#pragma once

#include "renderer/study/study_bench.h"

namespace lumifield {

/// Pictures of 160×120 of a scene lit by one luminaire with each visibility, exact but for that, beside the reference
/// with rays to many points of every tile (Lu, Pacanowski, Granier 2015, Fig. 7: ΔE 1.2 with about 49 tiles of 192×192
/// in a room with pillars). Errors: no OpenCL, the shadows' own, stopped.
Result<std::vector<FigureRow>> shadow_figures(StudyCamera& camera, const StudyLuminaire& luminaire,
                                              const StudyProgress& progress);

}  // namespace lumifield
