#pragma once

#include "renderer/study/study_bench.h"

namespace lumifield {

/// Every method at a ladder of costs on one luminaire. `quick` leaves the dear ends out.
Result<std::vector<StudyPoint>> climb_ladder(const StudyBench& bench, bool quick, const StudyProgress& progress);

/// One point of each method at 1024×768, its cost a middle one: errors are those of the ladder's picture.
Result<std::vector<StudyPoint>> confirm_at_full_size(const StudyBench& bench, StudyCamera& camera, bool quick,
                                                     const StudyProgress& progress);

/// Stopped by the one who asked.
tl::unexpected<Error> study_stopped();

}  // namespace lumifield
