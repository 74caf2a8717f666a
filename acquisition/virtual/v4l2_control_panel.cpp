#include "acquisition/virtual/v4l2_control_panel.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <linux/videodev2.h>

namespace lumifield::virtual_bench {

V4l2ControlPanel::V4l2ControlPanel(const std::set<std::uint32_t>& stubborn, const std::set<std::uint32_t>& missing)
    : controls_(out_of_the_box()) {
  std::erase_if(controls_, [&](const Control& control) { return missing.contains(control.id); });
  for (Control& control : controls_) control.is_stubborn = stubborn.contains(control.id);
}

std::map<std::uint32_t, int> V4l2ControlPanel::values() const {
  std::map<std::uint32_t, int> values;
  for (const Control& control : controls_) values[control.id] = control.value;
  return values;
}

std::vector<V4l2ControlPanel::Control> V4l2ControlPanel::out_of_the_box() {
  constexpr std::uint32_t number = V4L2_CTRL_TYPE_INTEGER, flag = V4L2_CTRL_TYPE_BOOLEAN, menu = V4L2_CTRL_TYPE_MENU;
  return {{V4L2_CID_AUTO_WHITE_BALANCE, flag, "White Balance, Automatic", 0, 1, 1, 1, {}},
          {V4L2_CID_GAMMA, number, "Gamma", 1, 500, 220, 220, {}},
          {V4L2_CID_AUTOGAIN, flag, "Gain, Automatic", 0, 1, 1, 1, {}},
          {V4L2_CID_GAIN, number, "Gain", 0, 240, 32, 32, {}},
          {V4L2_CID_POWER_LINE_FREQUENCY, menu, "Power Line Frequency", 0, 2, 1, 1, {"Disabled", "50 Hz", "60 Hz"}},
          {V4L2_CID_BACKLIGHT_COMPENSATION, number, "Backlight Compensation", 0, 2, 1, 1, {}},
          {V4L2_CID_EXPOSURE_AUTO,
           menu,
           "Auto Exposure",
           0,
           3,
           3,
           3,
           {nullptr, "Manual Mode", nullptr, "Aperture Priority Mode"}},
          {V4L2_CID_EXPOSURE_ABSOLUTE, number, "Exposure Time, Absolute", 1, 100'000, 156, 156, {}}};
}

V4l2ControlPanel::Control* V4l2ControlPanel::find(std::uint32_t id) {
  const bool next = (id & V4L2_CTRL_FLAG_NEXT_CTRL) != 0;
  Control* found = nullptr;
  for (Control& control : controls_) {
    const bool fits = next ? control.id > (id & V4L2_CTRL_ID_MASK) : control.id == id;
    if (fits && (found == nullptr || control.id < found->id)) found = &control;
  }
  return found;
}

int V4l2ControlPanel::answer(std::uint32_t request, void* data) {
  std::uint32_t id = *static_cast<std::uint32_t*>(data);  // the first member of them all
  if (request == VIDIOC_QUERY_EXT_CTRL && (id & V4L2_CTRL_FLAG_NEXT_CTRL) != 0) id &= ~V4L2_CTRL_FLAG_NEXT_COMPOUND;
  Control* const control = find(id);
  if (control == nullptr) return EINVAL;
  const auto describe = [&](auto& entry) {
    std::memset(&entry, 0, sizeof entry);
    entry.id = control->id, entry.type = control->type;
    std::strcpy(reinterpret_cast<char*>(entry.name), control->name);
    entry.minimum = control->minimum, entry.maximum = control->maximum;
    entry.step = 1, entry.default_value = control->standard;
  };
  switch (request) {
    case VIDIOC_QUERYCTRL:
      describe(*static_cast<v4l2_queryctrl*>(data));
      return 0;
    case VIDIOC_QUERY_EXT_CTRL: {
      auto& entry = *static_cast<v4l2_query_ext_ctrl*>(data);
      describe(entry);
      entry.elem_size = sizeof(int), entry.elems = 1;
      return 0;
    }
    case VIDIOC_QUERYMENU: {
      auto& entry = *static_cast<v4l2_querymenu*>(data);
      if (entry.index >= control->menu.size() || control->menu[entry.index] == nullptr) return EINVAL;
      std::memset(entry.name, 0, sizeof entry.name);  // a packed structure's: no reference may be taken
      std::memcpy(entry.name, control->menu[entry.index], std::strlen(control->menu[entry.index]));
      return 0;
    }
    case VIDIOC_S_CTRL: {
      auto& entry = *static_cast<v4l2_control*>(data);
      entry.value = std::clamp(entry.value, control->minimum, control->maximum);
      if (!control->is_stubborn) control->value = entry.value;
      return 0;
    }
    default:
      static_cast<v4l2_control*>(data)->value = control->value;
      return 0;
  }
}

}  // namespace lumifield::virtual_bench
