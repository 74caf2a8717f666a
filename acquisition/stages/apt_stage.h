#pragma once

#include <memory>
#include <vector>

#include "acquisition/stage.h"

namespace lumifield {

/// Two axes of Thorlabs controllers on USB that speak APT (AptSettings): a pair of one-axis controllers such as KDC101,
/// or two bays of one, such as BBD302 or BSC202. Readings are counts / counts_per_mm · direction, 0 at home.
///
///     opened ──home──→ standing ──move_to──→ moving (both axes at once) → standing
///        ↑                ↑                    │ stop, halt(): MOVE_STOP, profiled … MOVE_STOPPED; position kept
///        └ motion error ──┴────────────────────┘
///
/// Opening enables the channels, sets rapid_mm_s and acceleration_mm_s2 and reads them back, and stops what a former
/// owner left moving. A motion ends with MOVE_COMPLETED or MOVE_HOMED; meanwhile each axis is asked for its status 20
/// times a second, so that silence, limit switches and motion errors are seen. The deadline of a move is twice the
/// longer of the axes' trapezoid predictions and 2 s, that of homing follows from travel and homing velocity. Homing is
/// remembered by the controller for as long as it has power, also while it is unplugged from USB.
///
/// Lost steps. Servos (kdc101, bbd30x) report the encoder's position: what they do not reach, the reading shows.
/// Steppers (bsc20x) report the position that was commanded. There is no look for the home switches (check_home).
///
/// Errors beyond those of Stage: no controller of that serial, no permission, in use, gone (unplugged; open it again),
/// speeds not taken, motion error, limit switch, not homed, a fault that the controller tells.
Result<std::unique_ptr<Stage>> open_apt_stage(const StageSettings& settings);

/// Controllers on USB, in use or not; none is stopped or reset. `path` is of no concern to them.
std::vector<DeviceReport> find_apt_stages(const std::string& path);

/// The controllers that a bench file names, answering or not.
DeviceReport probe_apt_stage(const StageSettings& settings);

}  // namespace lumifield
