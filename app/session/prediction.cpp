#include "app/session/prediction.h"

#include "acquisition/scan/motion_time.h"
#include "app/session/disk_room.h"
#include "app/session/stored_bytes.h"

namespace lumifield {
namespace {

std::optional<double> room_of(const Result<DiskRoom>& disk) {
  return disk ? std::optional(disk->free_bytes) : std::nullopt;
}

}  // namespace

bool ScanPrediction::has_room() const {
  const double here = bytes + (recording && recording->on_same_disk ? recording->bytes : 0);
  if (free_bytes && *free_bytes < here) return false;
  return !recording || !recording->free_bytes || *recording->free_bytes >= recording->bytes;
}

Bench at_the_pace_of(const Camera& camera, const Plan& plan, Bench bench) {
  bench.camera.readout_s = std::max(bench.camera.readout_s, camera.frame_wait_s(plan.exposures_s));
  return bench;
}

ScanPrediction predict(const Bench& bench, const Plan& plan, const ScanPlan& steps, const StageInfo& stage,
                       const std::filesystem::path& out, const std::filesystem::path& recorded) {
  const Result<DiskRoom> disk = disk_room(out);
  ScanPrediction scan{steps.cells, scan_time_s(steps.steps, bench, plan, stage_speed(bench.stage, stage)),
                      plan.stabilisation ? plan.stabilisation->limit_s : 0, stored_bytes(bench, plan, steps.cells),
                      room_of(disk)};
  if (recorded.empty()) return scan;
  const Result<DiskRoom> theirs = disk_room(recorded);
  scan.recording = {recorded_bytes(bench, plan, steps), room_of(theirs), disk && theirs && share_room(*disk, *theirs)};
  return scan;
}

}  // namespace lumifield
