#pragma once

#include <string>
#include <string_view>

#include "acquisition/virtual/gcode.h"

namespace lumifield::virtual_bench {

/// GRBL's `$n=v` settings of a two-axis stage (a third axis is listed and does nothing). Value type.
class GrblSettings {
 public:
  GrblSettings(const Vec2& travel_mm, double rapid_mm_s, double acceleration_mm_s2);

  double operator[](int number) const;
  bool on(int number) const { return (*this)[number] != 0; }
  /// The pair of axis settings number and number + 1.
  Vec2 axes(int number) const { return {(*this)[number], (*this)[number + 1]}; }

  /// `assignment`: the part after `$` of "$110=6000".
  GrblError set(std::string_view assignment);
  /// What `$$` prints, line by line.
  std::string list() const;

 private:
  struct Setting {
    int number;
    double value;
    int decimals;
  };
  Setting settings_[34];
};

}  // namespace lumifield::virtual_bench
