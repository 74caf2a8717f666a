#pragma once

#include <filesystem>
#include <optional>

#include "acquisition/camera.h"
#include "acquisition/scan/scan_plan.h"
#include "acquisition/stage.h"

namespace lumifield {

/// What the frames of a scan that is recorded take. Value type.
struct RecordingPrediction {
  double bytes = 0;                  ///< at most; what has to be taken again comes on top
  std::optional<double> free_bytes;  ///< on the disk that they are kept on; absent where it does not tell
  bool on_same_disk = false;         ///< as the cells: both share its room
};

/// What a scan will take, told before its first cell. Value type.
struct ScanPrediction {
  int cells = 0;                     ///< to be scanned
  double time_s = 0;                 ///< by the speeds that the controller reports, without the stabilisation
  double stabilisation_s = 0;        ///< at most before that, until the lamp is steady
  double bytes = 0;                  ///< of the cells, at most
  std::optional<double> free_bytes;  ///< on the disk that they are stored on; absent where it does not tell
  std::optional<RecordingPrediction> recording = {};  ///< where its frames are kept too

  bool has_room() const;
};

/// The bench as it is for predictions and for what counts as read-out, with a camera that is open: one that runs free
/// is waited for.
Bench at_the_pace_of(const Camera& camera, const Plan& plan, Bench bench);

/// Of `steps`; `stage` is open, `out` need not be there. `recorded`: the folder of the recorded frames; empty, there
/// are none.
ScanPrediction predict(const Bench& bench, const Plan& plan, const ScanPlan& steps, const StageInfo& stage,
                       const std::filesystem::path& out, const std::filesystem::path& recorded = {});

}  // namespace lumifield
