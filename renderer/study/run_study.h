#pragma once

#include <filesystem>
#include <vector>

#include "luminaire/scene.h"
#include "renderer/study/study_bench.h"

namespace lumifield {

struct StudyJob {
  Scene scene;  ///< its first luminaire's place is taken, of a whole frame all places
  std::vector<StudyLuminaire> luminaires;
  bool quick = false;
  bool ladders_only = false;    ///< no stability table, none of the paper's figures
  std::filesystem::path cache;  ///< of references (reference_cache.h); empty: none are kept
};

/// The whole study: the ladder of every method on every luminaire, one point of each at 1024×768 on the first; the
/// ladders of closed-form and position-dependent in shadow, and with gloss on the first; shadows beside the
/// reference's; mis beside its parts; a whole frame of the last luminaire at all its places; the stability table; the
/// paper's figures; those of shift-invariant; and where the scene names an environment, those of gloss lit by it.
/// If quick, looks, shadows and mis are the first luminaire's alone. Opens an EGL context and OpenCL on the calling
/// thread. A part that fails is one of the study's omissions, as is a luminaire that lights nothing seen; all else goes
/// on. Errors: the scene's and, before anything is computed, its environment's, no EGL, that of the first luminaire
/// where none has a ladder (no OpenCL), stopped (ErrorKind::stopped).
Result<Study> run_study(const StudyJob& job, const StudyProgress& progress);

}  // namespace lumifield
