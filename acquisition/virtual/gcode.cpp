#include "acquisition/virtual/gcode.h"

#include <charconv>
#include <cmath>
#include <map>
#include <set>

namespace lumifield::virtual_bench {

using enum GrblError;

/// A line taken apart. G numbers are in tenths: G92.1 is 921.
struct Gcode::Words {
  std::set<int> g;
  std::map<char, double> value;

  bool has(int code) const { return g.contains(code); }
  bool axes() const { return value.contains('X') || value.contains('Y'); }
  static GrblError parse(std::string_view line, Words& words);

 private:
  GrblError add(char letter, double number);
};

namespace {

// GRBL's modal groups; two words of one group on a line are an error.
const std::map<int, char> kGroupOfG = {{0, 'm'},   {10, 'm'},  {800, 'm'}, {40, '0'},  {100, '0'}, {530, '0'},
                                       {920, '0'}, {921, '0'}, {170, 'p'}, {200, 'u'}, {210, 'u'}, {400, 'c'},
                                       {490, 'l'}, {540, 'w'}, {900, 'd'}, {910, 'd'}, {940, 'f'}};

constexpr double kMmPerInch = 25.4, kNumberMax = 1e8;  // GRBL reads 8 digits

}  // namespace

GrblError Gcode::Words::parse(std::string_view line, Words& words) {
  for (std::size_t at = 0; at < line.size();) {
    const char letter = line[at++];
    if (letter < 'A' || letter > 'Z') return no_letter;
    if (at < line.size() && line[at] == '+') ++at;
    const bool number_begins = at < line.size() && (std::isdigit(line[at]) || line[at] == '-' || line[at] == '.');
    if (!number_begins) return bad_number;
    double number = 0;
    const char* end = line.data() + line.size();
    const auto [rest, fault] = std::from_chars(line.data() + at, end, number, std::chars_format::fixed);
    if (fault != std::errc() || !(std::abs(number) < kNumberMax)) return bad_number;
    at = std::size_t(rest - line.data());
    if (const GrblError error = words.add(letter, number); error != none) return error;
  }
  return none;
}

GrblError Gcode::Words::add(char letter, double number) {
  if (letter == 'G') {
    const double tenths = number * 10;
    const int code = std::abs(tenths) < 1e4 ? int(std::lround(tenths)) : -1;
    const auto group = kGroupOfG.find(code);
    if (group == kGroupOfG.end() || std::abs(tenths - code) > 1e-6) return unsupported;
    for (const int other : g)
      if (kGroupOfG.at(other) == group->second) return modal_group;
    g.insert(code);
    return none;
  }
  if (letter == 'M') return number == 5 || number == 9 ? none : unsupported;
  if (std::string_view("XYFPLN").find(letter) == std::string_view::npos) return unsupported;
  if (std::string_view("FPLN").find(letter) != std::string_view::npos && number < 0) return negative_value;
  return value.emplace(letter, number).second ? none : repeated_word;
}

GrblError Gcode::set_offsets(const Words& words, const Vec2& position_mm, Modal& modal) {
  const double unit = modal.inches ? kMmPerInch : 1;
  if (words.has(921)) {
    modal.g92_mm = Vec2::Zero();
    return none;
  }
  if (!words.axes()) return no_axis_words;
  if (words.has(100)) {
    if (!words.value.contains('L') || !words.value.contains('P')) return value_missing;
    if (words.value.at('L') != 2 && words.value.at('L') != 20) return unsupported;
    if (words.value.at('P') > 1) return bad_coordinates;
  }
  for (int axis = 0; axis < 2; ++axis) {
    const auto word = words.value.find("XY"[axis]);
    if (word == words.value.end()) continue;
    const double value = word->second * unit;
    if (words.has(920))
      modal.g92_mm[axis] = position_mm[axis] - modal.g54_mm[axis] - value;
    else if (words.value.at('L') == 20)
      modal.g54_mm[axis] = position_mm[axis] - modal.g92_mm[axis] - value;
    else
      modal.g54_mm[axis] = value;
  }
  return none;
}

GrblError Gcode::interpret(const Words& words, const Vec2& position_mm, Modal& modal, GcodeAction& action) {
  // Modal words come first.
  if (words.has(200)) modal.inches = true;
  if (words.has(210)) modal.inches = false;
  if (words.has(900)) modal.absolute = true;
  if (words.has(910)) modal.absolute = false;
  const double unit = modal.inches ? kMmPerInch : 1;
  if (words.value.contains('F')) modal.feed_mm_min = words.value.at('F') * unit;
  const bool explicit_motion = words.has(0) || words.has(10);
  for (const int motion : {0, 10, 800})
    if (words.has(motion)) modal.motion = motion;

  // Then what does not last: offsets, a dwell.
  const bool offsets = words.has(100) || words.has(920) || words.has(921);
  const bool takes_p = words.has(100) || words.has(40);
  if (words.value.contains('P') && !takes_p) return unused_words;
  if (words.value.contains('L') && !words.has(100)) return unused_words;
  if (offsets && explicit_motion && words.axes()) return axis_words_conflict;
  if (offsets) return set_offsets(words, position_mm, modal);
  if (words.has(40)) {
    if (!words.value.contains('P')) return value_missing;
    action.dwell_s = words.value.at('P');
  }

  // Then motion.
  if (words.has(530) && modal.motion == 800) return g53_needs_motion;
  if (!words.axes()) return none;
  if (modal.motion == 800) return axis_words_unused;
  if (modal.motion == 10 && modal.feed_mm_min <= 0) return no_feed;
  action.moves = true;
  action.rapid = modal.motion == 0;
  action.feed_mm_min = modal.feed_mm_min;
  action.target_mm = position_mm;
  const Vec2 origin = words.has(530) ? Vec2(Vec2::Zero()) : Vec2(modal.g54_mm + modal.g92_mm);
  for (int axis = 0; axis < 2; ++axis) {
    const auto word = words.value.find("XY"[axis]);
    if (word == words.value.end()) continue;
    const bool absolute = modal.absolute || words.has(530);
    action.target_mm[axis] = (absolute ? origin[axis] : position_mm[axis]) + word->second * unit;
  }
  return none;
}

GrblError Gcode::execute(std::string_view line, const Vec2& position_mm, GcodeAction& action) {
  Words words;
  if (const GrblError error = Words::parse(line, words); error != none) return error;
  Modal modal = modal_;
  const GrblError error = interpret(words, position_mm, modal, action);
  if (error == none) modal_ = modal;
  return error;
}

void Gcode::reset() {
  const Vec2 kept = modal_.g54_mm;
  modal_ = Modal();
  modal_.g54_mm = kept;
}

}  // namespace lumifield::virtual_bench
