#include "app/session/prediction.h"

#include "acquisition/scan/motion_time.h"
#include "app/session/stored_bytes.h"

namespace lumifield {

namespace {

/// Of the disk that a path will lie on.
std::optional<double> room_for(std::filesystem::path out) {
  std::error_code code;
  out = std::filesystem::absolute(out, code);
  while (!code && !out.empty() && !std::filesystem::exists(out, code) && out.has_relative_path())
    out = out.parent_path();
  const std::filesystem::space_info space = std::filesystem::space(out, code);
  return code ? std::nullopt : std::optional(static_cast<double>(space.available));
}

}  // namespace

Bench at_the_pace_of(const CameraInfo& camera, Bench bench) {
  bench.camera.readout_s = std::max(bench.camera.readout_s, camera.frame_wait_s);
  return bench;
}

ScanPrediction predict(const Bench& bench, const Plan& plan, const ScanPlan& steps, const StageInfo& stage,
                       const std::filesystem::path& out) {
  return {steps.cells, scan_time_s(steps.steps, bench, plan, stage_speed(bench.stage, stage)),
          plan.stabilisation ? plan.stabilisation->limit_s : 0, stored_bytes(bench, plan, steps.cells), room_for(out)};
}

}  // namespace lumifield
