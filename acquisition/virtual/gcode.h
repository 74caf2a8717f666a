#pragma once

#include <string_view>

#include "luminaire/geometry.h"

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
  axis_words_conflict = 24,
  repeated_word = 25,
  no_axis_words = 26,
  value_missing = 28,
  bad_coordinates = 29,
  g53_needs_motion = 30,
  axis_words_unused = 31,
  unused_words = 36
};

/// What a line asks of the machine, in mm of the machine's frame.
struct GcodeAction {
  bool moves = false, rapid = false;
  Vec2 target_mm{0, 0};
  double feed_mm_min = 0, dwell_s = 0;
};

/// The subset of G-code that a two-axis stage uses, with GRBL 1.1's modal state and error numbers: G0 G1 G4 G10 L2|L20
/// P1 G17 G20 G21 G40 G49 G53 G54 G80 G90 G91 G92 G92.1 G94, words F X Y N, M5 M9. Any other word, Z included, is
/// refused. A refused line changes nothing. Thread-bound.
class Gcode {
 public:
  /// `position_mm`: where the motion accepted so far ends.
  GrblError execute(std::string_view line, const Vec2& position_mm, GcodeAction& action);

  /// Work position + this = machine position.
  Vec2 work_offset_mm() const { return modal_.g54_mm + modal_.g92_mm; }
  /// As after power-up; G54 is kept.
  void reset();

 private:
  struct Modal {
    int motion = 0;
    bool absolute = true, inches = false;
    double feed_mm_min = 0;
    Vec2 g54_mm{0, 0}, g92_mm{0, 0};
  };
  struct Words;
  static GrblError interpret(const Words& words, const Vec2& position_mm, Modal& modal, GcodeAction& action);
  static GrblError set_offsets(const Words& words, const Vec2& position_mm, Modal& modal);
  Modal modal_;
};

}  // namespace lumifield::virtual_bench
