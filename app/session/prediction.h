#pragma once

#include <filesystem>
#include <optional>

#include "acquisition/camera.h"
#include "acquisition/scan/scan_plan.h"
#include "acquisition/stage.h"

namespace lumifield {

/// What a scan will take, told before its first cell. Value type.
struct ScanPrediction {
  int cells = 0;                     ///< to be scanned
  double time_s = 0;                 ///< by the speeds that the controller reports, without the stabilisation
  double stabilisation_s = 0;        ///< at most before that, until the lamp is steady
  double bytes = 0;                  ///< of the cells, at most
  std::optional<double> free_bytes;  ///< on the disk that they are stored on; absent where it does not tell

  bool has_room() const { return !free_bytes || *free_bytes >= bytes; }
};

/// The bench as it is for predictions and for what counts as read-out, with a camera that is open: one that runs free
/// is waited for.
Bench at_the_pace_of(const CameraInfo& camera, Bench bench);

/// Of `steps`; `stage` is open, `out` need not be there.
ScanPrediction predict(const Bench& bench, const Plan& plan, const ScanPlan& steps, const StageInfo& stage,
                       const std::filesystem::path& out);

}  // namespace lumifield
