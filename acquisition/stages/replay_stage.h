#pragma once

#include <memory>
#include <string>

#include "acquisition/stage.h"

namespace lumifield {

/// The stage of a recorded scan, whose `path` is a folder of frames with places (cameras/frame_folder.h). No device:
/// nothing moves. It stands at once wherever it is sent, and reads as the recorded stage did: what was read nearest to
/// the target where that is within StageSettings::same_place_mm, else the target itself. Homing is at once, at (0, 0);
/// home switches there are none.
Result<std::unique_ptr<Stage>> open_replay_stage(const StageSettings& settings);

/// None: a folder is known by its name alone.
std::vector<DeviceReport> find_replay_stages(const std::string& path);

DeviceReport probe_replay_stage(const StageSettings& settings);

}  // namespace lumifield
