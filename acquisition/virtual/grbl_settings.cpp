#include "acquisition/virtual/grbl_settings.h"

#include <algorithm>
#include <cassert>
#include <charconv>
#include <cmath>
#include <cstdio>

namespace lumifield::virtual_bench {

GrblSettings::GrblSettings(const Vec2& travel_mm, double rapid_mm_s, double acceleration_mm_s2)
    : settings_{{0, 10, 0},
                {1, 25, 0},
                {2, 0, 0},
                {3, 0, 0},
                {4, 0, 0},
                {5, 0, 0},
                {6, 0, 0},
                {10, 1, 0},
                {11, 0.010, 3},
                {12, 0.002, 3},
                {13, 0, 0},
                {20, 1, 0},
                {21, 1, 0},
                {22, 1, 0},
                {23, 3, 0},
                {24, 600, 3},
                {25, 6000, 3},
                {26, 250, 0},
                {27, 1, 3},
                {30, 1000, 0},
                {31, 0, 0},
                {32, 0, 0},
                {100, 250, 3},
                {101, 250, 3},
                {102, 250, 3},
                {110, rapid_mm_s * 60, 3},
                {111, rapid_mm_s * 60, 3},
                {112, 500, 3},
                {120, acceleration_mm_s2, 3},
                {121, acceleration_mm_s2, 3},
                {122, 10, 3},
                {130, travel_mm.x(), 3},
                {131, travel_mm.y(), 3},
                {132, 200, 3}} {}

double GrblSettings::operator[](int number) const {
  const auto* found = std::ranges::find(settings_, number, &Setting::number);
  assert(found != std::end(settings_));
  return found->value;
}

GrblError GrblSettings::set(std::string_view assignment) {
  const char* end = assignment.data() + assignment.size();
  int number = 0;
  const auto [equals, no_number] = std::from_chars(assignment.data(), end, number);
  if (no_number != std::errc() || equals == end || *equals != '=') return GrblError::bad_statement;
  double value = 0;
  const auto [rest, fault] = std::from_chars(equals + 1, end, value, std::chars_format::fixed);
  if (fault != std::errc() || rest != end || !std::isfinite(value)) return GrblError::bad_number;
  auto* found = std::ranges::find(settings_, number, &Setting::number);
  if (found == std::end(settings_)) return GrblError::bad_statement;

  // Rates, accelerations, steps and travels of 0 would divide by zero in the firmware.
  if (value < 0 || (number >= 100 && value == 0)) return GrblError::negative_value;
  if (number == 20 && value != 0 && !on(22)) return GrblError::soft_limit_needs_homing;
  found->value = found->decimals == 0 ? std::floor(value) : value;
  return GrblError::none;
}

std::string GrblSettings::list() const {
  std::string text;
  for (const Setting& setting : settings_) {
    char line[48];
    std::snprintf(line, sizeof line, "$%d=%.*f\r\n", setting.number, setting.decimals, setting.value);
    text += line;
  }
  return text;
}

}  // namespace lumifield::virtual_bench
