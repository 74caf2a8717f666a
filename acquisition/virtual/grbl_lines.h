#pragma once

#include <map>
#include <string>
#include <string_view>

#include "luminaire/geometry.h"

/// What the lines to a GRBL controller say: G-code and settings.
namespace lumifield::virtual_bench {

/// GRBL's answers to a line: `ok`, or `error:` and one of these numbers.
enum class GrblError {
  none = 0,
  no_letter = 1,
  bad_number = 2,
  bad_statement = 3,
  negative_value = 4,
  no_homing = 5,
  not_idle = 8,
  locked = 9,
  soft_limit_needs_homing = 10,
  line_too_long = 11,
  unsupported = 20,
  modal_group = 21,
  no_feed = 22,
  repeated_word = 25,
  value_missing = 28,
  g53_needs_motion = 30,
  axis_words_unused = 31,
  unused_words = 36
};

/// A line without comments and blanks, in capitals.
std::string stripped(std::string_view line);

/// What a line asks of the machine, in mm of the machine's frame.
struct GcodeAction {
  bool moves = false;
  Vec2 target_mm{0, 0};
  double feed_mm_min = 0;  ///< infinite: as fast as it goes
  double dwell_s = 0;
};

/// The subset of G-code that a two-axis stage uses, with GRBL 1.1's modal state and error numbers: G0 G1 G4 G17 G21 G40
/// G49 G53 G54 G80 G90 G91 G94, words F X Y N, M5 M9. Work and machine coordinates are the same: no offset can be set.
/// Any other word, Z and inches included, is refused. A refused line changes nothing. Value type.
class Gcode {
 public:
  /// `line` is stripped; `position_mm`: where the motion accepted so far ends.
  GrblError execute(std::string_view line, const Vec2& position_mm, GcodeAction& action);

 private:
  int motion_ = 0;  // the G number in tenths
  bool absolute_ = true;
  double feed_mm_min_ = 0;
};

/// GRBL's `$n=v` settings of a two-axis stage (a third axis is listed and does nothing). Value type.
class GrblSettings {
 public:
  GrblSettings(const Vec2& travel_mm, double rapid_mm_s, double acceleration_mm_s2);

  double operator[](int number) const { return values_.at(number); }
  bool on(int number) const { return values_.at(number) != 0; }
  /// The settings of the x and the y axis: number and number + 1.
  Vec2 axes(int number) const { return {values_.at(number), values_.at(number + 1)}; }

  /// `assignment`: the part after `$` of "$110=6000".
  GrblError set(std::string_view assignment);
  /// What `$$` prints.
  std::string list() const;

 private:
  std::map<int, double> values_;
};

}  // namespace lumifield::virtual_bench
