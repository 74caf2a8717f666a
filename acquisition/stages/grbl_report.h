#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "luminaire/error.h"
#include "luminaire/geometry.h"

namespace lumifield {

/// The lines that a GRBL 1.1 controller sends, taken apart. Pure functions on one line each.
/// Source: gnea/grbl wiki, "Grbl v1.1 Interface", "Configuration"; CSV tables of error and alarm codes.

enum class GrblState { idle, run, hold, jog, alarm, door, check, home, sleep };

/// `<Idle|MPos:1.000,2.000,0.000|FS:0,0|WCO:0.000,0.000,0.000>`, in the controller's report unit.
struct GrblStatus {
  GrblState state = GrblState::idle;
  int sub_state = 0;  ///< Hold: 0 stands still, 1 still decelerating
  Vec2 position{0, 0};
  bool machine_position = true;             ///< MPos, else WPos = MPos − WCO
  bool x_closed = false, y_closed = false;  ///< Pn: the axes' limit switches
  std::optional<Vec2> work_offset;          ///< WCO, sent with every 10th to 30th report
};

std::optional<GrblStatus> parse_grbl_status(std::string_view line);

/// `$110=3000.000` to (110, 3000).
std::optional<std::pair<int, double>> parse_grbl_setting(std::string_view line);
using GrblSettings = std::map<int, double>;

/// The number behind `ALARM:` or `error:`.
std::optional<int> parse_grbl_code(std::string_view line, std::string_view prefix);

bool is_grbl_banner(std::string_view line);

/// What the code means and what the operator can do, by the controller's own tables.
Error grbl_alarm(int code, std::string where);
Error grbl_error(int code, std::string where);

/// Non-printing bytes as \xNN, cut to 60 characters: unreadable answers in messages.
std::string printable(std::string_view bytes);

}  // namespace lumifield
