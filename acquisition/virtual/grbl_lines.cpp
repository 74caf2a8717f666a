#include "acquisition/virtual/grbl_lines.h"

#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <set>

namespace lumifield::virtual_bench {

using enum GrblError;

std::string stripped(std::string_view line) {
  std::string bare;
  bool comment = false;
  for (const char c : line.substr(0, line.find(';'))) {
    if (c == '(') comment = true;
    if (!comment && c > ' ' && c != '%') bare += char(std::toupper(static_cast<unsigned char>(c)));
    if (c == ')') comment = false;
  }
  return bare;
}

namespace {

/// Takes a number off the front. GRBL reads 8 digits and no exponent.
bool take_number(std::string_view& text, double& number) {
  if (text.starts_with('+')) text.remove_prefix(1);
  const auto [rest, fault] = std::from_chars(text.data(), text.data() + text.size(), number, std::chars_format::fixed);
  text.remove_prefix(std::size_t(rest - text.data()));
  return fault == std::errc() && std::abs(number) < 1e8;
}

/// A line taken apart: the numbers of its letters, and under its modal group, a small letter, that of each G.
using Words = std::map<char, double>;

GrblError add(Words& words, char letter, double number) {
  // Two words of one group on a line are an error.
  static const std::map<double, char> group_of_g = {{0, 'm'},  {1, 'm'},  {80, 'm'}, {4, 'o'},  {53, 'o'},
                                                    {17, 'p'}, {21, 'u'}, {40, 'c'}, {49, 'l'}, {54, 'w'},
                                                    {90, 'd'}, {91, 'd'}, {94, 'f'}};
  if (letter == 'G') {
    const auto group = group_of_g.find(number);
    if (group == group_of_g.end()) return unsupported;
    return words.emplace(group->second, number).second ? none : modal_group;
  }
  if (letter == 'M') return number == 5 || number == 9 ? none : unsupported;
  if (std::string_view("XYFPN").find(letter) == std::string_view::npos) return unsupported;
  if (std::string_view("FPN").find(letter) != std::string_view::npos && number < 0) return negative_value;
  return words.emplace(letter, number).second ? none : repeated_word;
}

GrblError parse(std::string_view line, Words& words) {
  while (!line.empty()) {
    const char letter = line[0];
    if (letter < 'A' || letter > 'Z') return no_letter;
    line.remove_prefix(1);
    double number = 0;
    if (!take_number(line, number)) return bad_number;
    if (const GrblError error = add(words, letter, number); error != none) return error;
  }
  return none;
}

}  // namespace

GrblError Gcode::execute(std::string_view line, const Vec2& position_mm, GcodeAction& action) {
  Words words;
  if (const GrblError error = parse(line, words); error != none) return error;
  const auto has = [&](char key) { return words.contains(key); };

  // What lasts comes first.
  Gcode next = *this;
  if (has('m')) next.motion_ = int(words['m']);
  if (has('d')) next.absolute_ = words['d'] == 90;
  if (has('F')) next.feed_mm_min_ = words['F'];

  const bool dwells = has('o') && words['o'] == 4, in_machine_frame = has('o') && words['o'] == 53;
  const bool moves = has('X') || has('Y'), cancelled = next.motion_ == 80;
  if (dwells != has('P')) return dwells ? value_missing : unused_words;
  if (in_machine_frame && cancelled) return g53_needs_motion;
  if (moves && cancelled) return axis_words_unused;
  if (moves && next.motion_ == 1 && next.feed_mm_min_ <= 0) return no_feed;

  action = {moves, position_mm, next.motion_ == 1 ? next.feed_mm_min_ : INFINITY, dwells ? words['P'] : 0};
  for (int axis = 0; axis < 2; ++axis)
    if (const auto word = words.find("XY"[axis]); word != words.end())
      action.target_mm[axis] = word->second + (next.absolute_ || in_machine_frame ? 0 : position_mm[axis]);
  *this = next;
  return none;
}

GrblSettings::GrblSettings(const Vec2& travel_mm, double rapid_mm_s, double acceleration_mm_s2)
    : values_{{0, 10},     {1, 25}, {2, 0},  {3, 0},     {4, 0},     {5, 0},     {6, 0},     {10, 1},   {11, 0.010},
              {12, 0.002}, {20, 1}, {21, 1}, {22, 1},    {23, 3},    {24, 600},  {25, 6000}, {26, 250}, {27, 1},
              {30, 1000},  {31, 0}, {32, 0}, {100, 250}, {101, 250}, {102, 250}, {112, 500}, {122, 10}, {132, 200}} {
  values_[110] = values_[111] = rapid_mm_s * 60;
  values_[120] = values_[121] = acceleration_mm_s2;
  values_[130] = travel_mm.x();
  values_[131] = travel_mm.y();
}

namespace {
bool is_real(int number) { return number >= 100 || std::set{11, 12, 24, 25, 27}.contains(number); }
}  // namespace

GrblError GrblSettings::set(std::string_view assignment) {
  double number = 0, value = 0;
  if (!take_number(assignment, number) || !assignment.starts_with('=')) return bad_statement;
  assignment.remove_prefix(1);
  if (!take_number(assignment, value) || !assignment.empty()) return bad_number;
  const int n = int(number);
  if (n != number || !values_.contains(n)) return bad_statement;

  // Rates, accelerations, steps and travels of 0 would divide by zero in the firmware.
  if (value < 0 || (n >= 100 && value == 0)) return negative_value;
  if (n == 20 && value != 0 && !on(22)) return soft_limit_needs_homing;
  values_[n] = is_real(n) ? value : std::floor(value);
  return none;
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
