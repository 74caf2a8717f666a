#pragma once

#include <memory>
#include <string>
#include <vector>

#include "acquisition/stage.h"

namespace lumifield {

/// A GRBL 1.1 controller on a serial line, 115200 baud. Its X and Y are the stage's axes; positions are machine
/// positions (MPos), whatever work offsets, report mask ($10) or report unit ($13) are set.
///
///     opened → locked ──home──→ standing ──move_to──→ moving → standing
///                 ↑                 ↑                   │ stop, halt(): `!` … Hold:0, reset; position kept
///                 └──── ALARM ──────┴───────────────────┘
///
/// Opening stops what a former owner left moving, then resets the parser; a position is kept through both. Boards that
/// restart when the port is opened get three seconds. Motion is watched by asking `?` about 200 times a second; the
/// deadline of a move is twice its trapezoid prediction and 2 s, that of homing follows from travel and homing speeds.
/// halt() during homing has to reset the controller: a feed hold is ignored there, and no position is lost that was
/// known.
///
/// Lost steps. The controller reports the position that it commanded. With StageSettings::check_home, homing ends with
/// a look for the readings at which the home switches close ($23 says where they are, Pn: of a report that they have);
/// slipped_mm looks again. Both ask for $20=0 and $21=0, which opening checks: the switches lie beyond the soft limits,
/// and with hard limits a switch that closes is an alarm.
///
/// Errors beyond those of Stage: controller restarted, put on hold or door opened by hand, unreadable answers, hang-up.
Result<std::unique_ptr<Stage>> open_grbl_stage(const StageSettings& settings);

/// Serial ports that look like a stage (/dev/tty{USB,ACM}*) and `path` if given, usable or not. What answers is asked
/// for its name without disturbing it: neither reset nor hold.
std::vector<DeviceReport> find_grbl_stages(const std::string& path);

/// The port that a bench file names, asked likewise.
DeviceReport probe_grbl_stage(const StageSettings& settings);

}  // namespace lumifield
