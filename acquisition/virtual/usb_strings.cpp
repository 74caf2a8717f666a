#include <algorithm>
#include <cerrno>

#include "acquisition/virtual/usb_device.h"

namespace lumifield::virtual_bench {

namespace {
constexpr std::uint8_t standard_in = 0x80, get_descriptor = 6, string_descriptor = 3, english[2] = {0x09, 0x04};
}  // namespace

bool asks_for_usb_string(const std::uint8_t* setup) {
  return setup[0] == standard_in && setup[1] == get_descriptor && setup[3] == string_descriptor;
}

int tell_usb_string(std::span<const std::string> strings, std::uint8_t* setup) {
  const std::size_t index = setup[2], length = setup[6] | std::size_t(setup[7]) << 8;
  if (index > strings.size()) return -EPIPE;
  std::vector<std::uint8_t> text{0, string_descriptor};
  if (index == 0) text.insert(text.end(), english, english + 2);
  if (index > 0)
    for (const char c : strings[index - 1]) text.push_back(static_cast<std::uint8_t>(c)), text.push_back(0);
  text[0] = static_cast<std::uint8_t>(text.size());
  const std::size_t count = std::min(length, text.size());
  std::copy_n(text.begin(), count, setup + 8);
  return static_cast<int>(count);
}

}  // namespace lumifield::virtual_bench
