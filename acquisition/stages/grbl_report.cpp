#include "acquisition/stages/grbl_report.h"

#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>

namespace lumifield {
namespace {

/// The part up to `separator`, which is taken off `text` with it.
std::string_view take_until(std::string_view& text, char separator) {
  const std::size_t end = text.find(separator);
  const std::string_view part = text.substr(0, end);
  text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
  return part;
}

template <class Number>
std::optional<Number> to_number(std::string_view text) {
  Number number{};
  const auto [end, fault] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (fault != std::errc() || end != text.data() + text.size()) return std::nullopt;
  if constexpr (std::is_floating_point_v<Number>)
    if (!std::isfinite(number)) return std::nullopt;
  return number;
}

/// "x,y" or "x,y,z,…".
std::optional<Vec2> to_xy(std::string_view text) {
  const auto x = to_number<double>(take_until(text, ','));
  const auto y = to_number<double>(take_until(text, ','));
  if (!x || !y) return std::nullopt;
  return Vec2(*x, *y);
}

std::optional<GrblState> to_state(std::string_view name) {
  constexpr std::array<std::pair<std::string_view, GrblState>, 9> names{{{"Idle", GrblState::idle},
                                                                         {"Run", GrblState::run},
                                                                         {"Hold", GrblState::hold},
                                                                         {"Jog", GrblState::jog},
                                                                         {"Alarm", GrblState::alarm},
                                                                         {"Door", GrblState::door},
                                                                         {"Check", GrblState::check},
                                                                         {"Home", GrblState::home},
                                                                         {"Sleep", GrblState::sleep}}};
  for (const auto& [known, state] : names)
    if (known == name) return state;
  return std::nullopt;
}

}  // namespace

std::optional<GrblStatus> parse_grbl_status(std::string_view line) {
  if (line.size() < 2 || line.front() != '<' || line.back() != '>') return std::nullopt;
  std::string_view rest = line.substr(1, line.size() - 2);
  std::string_view state_field = take_until(rest, '|');

  GrblStatus status;
  const auto state = to_state(take_until(state_field, ':'));
  if (!state) return std::nullopt;
  status.state = *state;
  if (!state_field.empty()) status.sub_state = to_number<int>(state_field).value_or(0);

  bool has_position = false;
  while (!rest.empty()) {
    std::string_view values = take_until(rest, '|');
    const std::string_view key = take_until(values, ':');
    if (key == "Pn")
      status.x_closed = values.find('X') != values.npos, status.y_closed = values.find('Y') != values.npos;
    if (key != "MPos" && key != "WPos" && key != "WCO") continue;
    const std::optional<Vec2> xy = to_xy(values);
    if (!xy) return std::nullopt;
    if (key == "WCO") {
      status.work_offset = xy;
    } else {
      status.position = *xy;
      status.machine_position = key == "MPos";
      has_position = true;
    }
  }
  if (!has_position) return std::nullopt;
  return status;
}

std::optional<std::pair<int, double>> parse_grbl_setting(std::string_view line) {
  if (line.empty() || line.front() != '$') return std::nullopt;
  line.remove_prefix(1);
  const auto number = to_number<int>(take_until(line, '='));
  const auto value = to_number<double>(take_until(line, ' '));  // some builds add "(comment)"
  if (!number || !value) return std::nullopt;
  return std::pair(*number, *value);
}

std::optional<int> parse_grbl_code(std::string_view line, std::string_view prefix) {
  if (!line.starts_with(prefix)) return std::nullopt;
  return to_number<int>(line.substr(prefix.size()));
}

bool is_grbl_banner(std::string_view line) { return line.starts_with("Grbl "); }

Error grbl_alarm(int code, std::string where) {
  const std::string name = "alarm " + std::to_string(code) + ", ";
  switch (code) {
    case 1:
      return {name + "a limit switch was hit; the position is lost", where, "clear the way, then home"};
    case 2:
      return {name + "the target lies beyond the soft limits", where, "correct limits_mm in the bench file"};
    case 3:
      return {name + "it was reset while moving; the position is lost", where, "home again"};
    case 4:
    case 5:
      return {name + "a probe failed", where, "home again"};
    case 6:
      return {name + "homing was interrupted by a reset", where, "home again"};
    case 7:
      return {name + "the safety door was opened while homing", where, "close the door, then home again"};
    case 8:
      return {name + "homing could not leave the switch", where, "check the switch, its wiring and $27"};
    case 9:
      return {name + "homing did not find the switch", where, "check the switch, its wiring and $130, $131"};
    default:
      return {name + "not in GRBL 1.1's table", where, "look it up in the controller's manual, then home"};
  }
}

Error grbl_error(int code, std::string where) {
  const std::string name = "error " + std::to_string(code) + ", ";
  switch (code) {
    case 5:
      return {name + "homing is switched off", where, "set $22=1, or \"home\": false in the bench file"};
    case 8:
      return {name + "not accepted unless it stands still", where, "wait, then try again"};
    case 9:
      return {name + "locked by an alarm", where, "home the stage"};
    case 13:
      return {name + "the safety door is open", where, "close the door"};
    case 15:
      return {name + "the target lies beyond its travel", where, "correct limits_mm in the bench file"};
    case 11:
    case 14:
      return {name + "the line was too long", where, "check that firmware is GRBL 1.1"};
    default:
      return {name + (code == 20 ? "command not supported" : "the command was not understood"), where,
              "check the cable for interference and that the firmware is GRBL 1.1"};
  }
}

std::string printable(std::string_view bytes) {
  std::string text;
  for (const char each : bytes) {
    if (text.size() > 60) return text + "...";
    const auto value = static_cast<unsigned char>(each);
    char escaped[5] = {each, 0};
    if (value < 0x20 || value > 0x7e) std::snprintf(escaped, sizeof escaped, "\\x%02x", value);
    text += escaped;
  }
  return text;
}

}  // namespace lumifield
