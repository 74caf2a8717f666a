#include "acquisition/stages/replay_stage.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "acquisition/cameras/frame_folder.h"

namespace lumifield {
namespace {

constexpr double at_once_mm_s = 1e6, at_once_mm_s2 = 1e9;  // for predictions

class ReplayStage final : public Stage {
 public:
  ReplayStage(const StageSettings& settings, std::vector<Vec2> readings_mm)
      : readings_mm_(std::move(readings_mm)), same_place_mm_(settings.same_place_mm) {
    info_ = {"replay", settings.path, at_once_mm_s, at_once_mm_s2, {0, 0}};
    for (const Vec2& reading : readings_mm_) info_.travel_mm = info_.travel_mm.cwiseMax(reading);
  }

  const StageInfo& info() const override { return info_; }
  Status home(std::stop_token stop) override { return move_to({0, 0}, std::move(stop)); }
  Status move_to(const Vec2& target_mm, std::stop_token stop) override {
    if (stop.stop_requested())
      return tl::unexpected<Error>({"stopped by the operator", info_.path, {}, ErrorKind::stopped});
    if (!target_mm.allFinite()) return fail("a target that is no place", info_.path, "correct the plan");
    const auto off_mm = [&](const Vec2& reading) { return (reading - target_mm).norm(); };
    const Vec2 nearest = *std::ranges::min_element(readings_mm_, {}, off_mm);
    at_mm_ = off_mm(nearest) <= same_place_mm_ ? nearest : target_mm;
    return {};
  }
  Result<Vec2> position() override { return at_mm_; }
  void halt() override {}  // there is nothing that moves

 private:
  std::vector<Vec2> readings_mm_;
  double same_place_mm_;
  StageInfo info_;
  Vec2 at_mm_{0, 0};
};

Result<std::vector<Vec2>> readings_of(const std::string& path) {
  const Result<std::vector<ListedFrame>> frames = read_frame_list(path);
  if (!frames) return tl::unexpected(frames.error());
  std::vector<Vec2> readings_mm;
  for (const ListedFrame& frame : *frames)
    if (frame.stage_mm) readings_mm.push_back(*frame.stage_mm);
  if (readings_mm.empty())
    return fail("lists no places", path, "give the columns stage_x_mm and stage_y_mm, or use a real stage");
  return readings_mm;
}

}  // namespace

Result<std::unique_ptr<Stage>> open_replay_stage(const StageSettings& settings) {
  if (settings.check_home)
    return fail("a replayed stage has no home switches that can be looked for", settings.path,
                "set \"check_home\" to false in the bench file");
  Result<std::vector<Vec2>> readings_mm = readings_of(settings.path);
  if (!readings_mm) return tl::unexpected(readings_mm.error());
  return std::make_unique<ReplayStage>(settings, std::move(*readings_mm));
}

std::vector<DeviceReport> find_replay_stages(const std::string&) { return {}; }

DeviceReport probe_replay_stage(const StageSettings& settings) {
  const Result<std::vector<Vec2>> readings_mm = readings_of(settings.path);
  if (!readings_mm) return {"stage", {}, settings.path, false, readings_mm.error().what, readings_mm.error().remedy};
  return {"stage", "replay of " + std::to_string(readings_mm->size()) + " frames' places", settings.path, true, {}, {}};
}

}  // namespace lumifield
