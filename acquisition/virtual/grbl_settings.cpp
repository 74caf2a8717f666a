#include "acquisition/virtual/grbl_settings.h"

#include <charconv>
#include <cmath>
#include <cstdio>

namespace lumifield::virtual_bench {

namespace {
bool is_real(int number) {
  return number >= 100 || number == 11 || number == 12 || (number >= 24 && number != 26 && number <= 27);
}
}  // namespace

GrblSettings::GrblSettings(const Vec2& travel_mm, double rapid_mm_s, double acceleration_mm_s2)
    : values_{{0, 10}, {1, 25},     {2, 0},      {3, 0},     {4, 0},     {5, 0},     {6, 0},
              {10, 1}, {11, 0.010}, {12, 0.002}, {13, 0},    {20, 1},    {21, 1},    {22, 1},
              {23, 3}, {24, 600},   {25, 6000},  {26, 250},  {27, 1},    {30, 1000}, {31, 0},
              {32, 0}, {100, 250},  {101, 250},  {102, 250}, {112, 500}, {122, 10},  {132, 200}} {
  values_[110] = values_[111] = rapid_mm_s * 60;
  values_[120] = values_[121] = acceleration_mm_s2;
  values_[130] = travel_mm.x();
  values_[131] = travel_mm.y();
}

GrblError GrblSettings::set(std::string_view assignment) {
  const char* end = assignment.data() + assignment.size();
  int number = 0;
  const auto [equals, no_number] = std::from_chars(assignment.data(), end, number);
  if (no_number != std::errc() || equals == end || *equals != '=') return GrblError::bad_statement;
  double value = 0;
  const auto [rest, fault] = std::from_chars(equals + 1, end, value, std::chars_format::fixed);
  if (fault != std::errc() || rest != end || !(std::abs(value) < 1e8)) return GrblError::bad_number;
  if (!values_.contains(number)) return GrblError::bad_statement;

  // Rates, accelerations, steps and travels of 0 would divide by zero in the firmware.
  if (value < 0 || (number >= 100 && value == 0)) return GrblError::negative_value;
  if (number == 20 && value != 0 && !on(22)) return GrblError::soft_limit_needs_homing;
  values_[number] = is_real(number) ? value : std::floor(value);
  return GrblError::none;
}

std::string GrblSettings::list() const {
  std::string text;
  for (const auto& [number, value] : values_) {
    char line[64];
    std::snprintf(line, sizeof line, "$%d=%.*f\r\n", number, is_real(number) ? 3 : 0, value);
    text += line;
  }
  return text;
}

}  // namespace lumifield::virtual_bench
