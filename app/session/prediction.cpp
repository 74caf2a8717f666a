#include "app/session/prediction.h"

#include <sys/stat.h>

#include "acquisition/scan/motion_time.h"
#include "app/session/stored_bytes.h"

namespace lumifield {

namespace {

struct Disk {
  std::optional<double> free_bytes;
  std::optional<dev_t> device;
};

/// That a path will lie on.
Disk disk_of(std::filesystem::path out) {
  std::error_code code;
  out = std::filesystem::absolute(out, code);
  while (!code && !out.empty() && !std::filesystem::exists(out, code) && out.has_relative_path())
    out = out.parent_path();
  const std::filesystem::space_info space = std::filesystem::space(out, code);
  Disk disk;
  if (!code) disk.free_bytes = static_cast<double>(space.available);
  struct stat status {};
  if (::stat(out.c_str(), &status) == 0) disk.device = status.st_dev;
  return disk;
}

}  // namespace

bool ScanPrediction::has_room() const {
  const double here = bytes + (recording && recording->on_same_disk ? recording->bytes : 0);
  if (free_bytes && *free_bytes < here) return false;
  return !recording || !recording->free_bytes || *recording->free_bytes >= recording->bytes;
}

Bench at_the_pace_of(const CameraInfo& camera, Bench bench) {
  bench.camera.readout_s = std::max(bench.camera.readout_s, camera.frame_wait_s);
  return bench;
}

ScanPrediction predict(const Bench& bench, const Plan& plan, const ScanPlan& steps, const StageInfo& stage,
                       const std::filesystem::path& out, const std::filesystem::path& recorded) {
  const Disk disk = disk_of(out);
  ScanPrediction scan{steps.cells, scan_time_s(steps.steps, bench, plan, stage_speed(bench.stage, stage)),
                      plan.stabilisation ? plan.stabilisation->limit_s : 0, stored_bytes(bench, plan, steps.cells),
                      disk.free_bytes};
  if (recorded.empty()) return scan;
  const Disk theirs = disk_of(recorded);
  scan.recording = {recorded_bytes(bench, plan, steps), theirs.free_bytes, disk.device && disk.device == theirs.device};
  return scan;
}

}  // namespace lumifield
