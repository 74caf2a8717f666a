#pragma once

#include <string_view>

namespace lumifield {

/// Where a scan stands.
///
///     idle → [homing →] moving → settling → exposing → delivering → moving … → parking → done
///     settling → moving                   the position read back is off: moved to once more
///     exposing → moving                   next pass of the cell, or a bracket taken again
///     idle → done                         nothing to scan
///     idle, homing, delivering → paused   between two steps, on the operator's word; → moving or parking after it
///     exposing, delivering → moving       the home switches are looked for; → homing when steps were lost, else goes
///                                         on: → moving, delivering, paused or parking
///     exposing → stabilising → moving     the lamp is not steady yet: the reference cell is read again after a while;
///                                         → moving too when it is
///     exposing → reconnecting → moving    the camera was gone and is back: the step is taken again
///     reconnecting → reconnecting         it is not back yet
///     any of a step → paused              a trouble that the operator has to help with; → homing, reconnecting or
///                                         moving after it
///     any but the last three → stopped    stop requested: the stage is halted and stays there (failed, when a device
///                                         fails meanwhile)
///     parking → stopped                   nobody attends, and the operator is to change the slide
///     any but the last three → failed     a device error, or nobody takes the cells: halted; parked before that
///                                         (→ parking → failed) when the stage still answers and homing was not what
///                                         failed
enum class ScanState {
  idle,
  homing,
  moving,
  settling,
  exposing,
  stabilising,
  delivering,
  reconnecting,
  paused,
  parking,
  done,
  stopped,
  failed
};

std::string_view to_string(ScanState state);

inline bool is_final(ScanState state) {
  return state == ScanState::done || state == ScanState::stopped || state == ScanState::failed;
}

/// The arrows of the drawing.
bool can_follow(ScanState from, ScanState to);

}  // namespace lumifield
