#include "acquisition/scan/scan_state.h"

namespace lumifield {

std::string_view to_string(ScanState state) {
  switch (state) {
    case ScanState::idle:
      return "idle";
    case ScanState::homing:
      return "homing";
    case ScanState::moving:
      return "moving";
    case ScanState::settling:
      return "settling";
    case ScanState::exposing:
      return "exposing";
    case ScanState::stabilising:
      return "stabilising";
    case ScanState::delivering:
      return "delivering";
    case ScanState::reconnecting:
      return "reconnecting";
    case ScanState::paused:
      return "paused";
    case ScanState::parking:
      return "parking";
    case ScanState::done:
      return "done";
    case ScanState::stopped:
      return "stopped";
    case ScanState::failed:
      return "failed";
  }
  return "";
}

bool can_follow(ScanState from, ScanState to) {
  using enum ScanState;
  if (is_final(from) || to == idle) return false;
  if (to == stopped || to == failed) return true;
  switch (from) {
    case idle:
      return to == homing || to == moving || to == paused || to == done;
    case homing:
      return to == moving || to == paused;
    case moving:
      return to == settling || to == moving || to == delivering || to == homing || to == paused || to == parking;
    case settling:
      return to == moving || to == exposing || to == paused || to == parking;
    case exposing:
      return to == moving || to == stabilising || to == delivering || to == reconnecting || to == paused ||
             to == parking;
    case stabilising:
    case delivering:
      return to == moving || to == paused || to == parking;
    case reconnecting:
      return to == moving || to == reconnecting || to == paused || to == parking;
    case paused:
      return to == homing || to == moving || to == reconnecting || to == paused || to == parking;
    case parking:
      return to == done;
    default:
      return false;
  }
}

}  // namespace lumifield
