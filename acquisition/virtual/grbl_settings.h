#pragma once

#include <map>
#include <string>
#include <string_view>

#include "acquisition/virtual/gcode.h"

namespace lumifield::virtual_bench {

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
