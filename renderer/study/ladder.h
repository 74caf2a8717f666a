#pragma once

#include "renderer/study/study_bench.h"

namespace lumifield {

/// What a ladder of costs found. A method that has no answer on this luminaire in this frame has no points, but a row
/// that tells why: refused where it will not take the luminaire or a receiver, failed where it breaks off.
struct Climb {
  std::vector<StudyPoint> points;
  std::vector<StabilityRow> without;
  bool is_without(Method method) const;
};

/// Every method at a ladder of costs on one luminaire; where its surfaces do not look plain, the closed form and the
/// position-dependent samples alone. `quick` leaves the dear ends out. Errors: the closed form's, and where it is
/// stopped.
Result<Climb> climb_ladder(const StudyBench& bench, bool quick, const StudyProgress& progress);

/// One point at 1024×768 of each method that has points, its cost a middle one: errors are those of the ladder's
/// picture. Adds to the climb.
Status confirm_at_full_size(const StudyBench& bench, StudyCamera& camera, bool quick, const StudyProgress& progress,
                            Climb& climb);

/// Stopped by the one who asked.
tl::unexpected<Error> study_stopped();

}  // namespace lumifield
