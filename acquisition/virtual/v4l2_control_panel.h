#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <vector>

namespace lumifield::virtual_bench {

/// The controls of a V4L2 camera out of its box: all that acts by itself is on. Those named stubborn take what they are
/// set to, and stay; those named missing are not there. Thread-bound.
class V4l2ControlPanel {
 public:
  V4l2ControlPanel(const std::set<std::uint32_t>& stubborn, const std::set<std::uint32_t>& missing);

  /// Answers QUERYCTRL, QUERY_EXT_CTRL, QUERYMENU, G_CTRL and S_CTRL: 0 or errno.
  int answer(std::uint32_t request, void* data);
  /// By id.
  std::map<std::uint32_t, int> values() const;

 private:
  struct Control {
    std::uint32_t id, type;
    const char* name;
    int minimum, maximum, standard, value;
    std::vector<const char*> menu;  ///< nullptr: a gap
    bool is_stubborn = false;
  };
  static std::vector<Control> out_of_the_box();
  Control* find(std::uint32_t id);

  std::vector<Control> controls_;
};

}  // namespace lumifield::virtual_bench
