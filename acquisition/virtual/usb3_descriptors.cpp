#include "acquisition/virtual/usb3_descriptors.h"

#include <cstdio>

namespace lumifield::virtual_bench::usb3 {
namespace {

constexpr std::uint16_t vendor = 0x1209, product = 0x0001, release = 0x0100;

// Of class EF 02 01: what belongs together is told by an association of interfaces.
constexpr const char* descriptors =
    "12010003EF02010909120100000101020301"
    "09025E00020100800C"
    "080B0002EF050000"
    "0904000002EF050000"
    "142401"
    "00000100"  // GenCP 1.0
    "00000100"  // USB3 Vision 1.0
    "0401020000000300"
    "08"  // super speed
    "07058102000400"
    "063000000000"
    "07050102000400"
    "063000000000"
    "0904010001EF050200"
    "07058202000400"
    "06300F000000";

}  // namespace

UsbDescription describe(const std::string& serial) {
  return {.vendor = vendor,
          .product = product,
          .release = release,
          .serial = serial,
          .speed_mbit_s = 5000,
          .descriptors = descriptors,
          .endpoints = {{answers, 0}, {commands, 0}, {frames, 1}}};
}

std::array<std::string, 4> strings(const std::string& serial) {
  std::uint32_t hash = 2166136261;  // FNV-1a
  for (const char c : serial) hash = (hash ^ static_cast<std::uint8_t>(c)) * 16777619;
  char guid[13];
  std::snprintf(guid, sizeof guid, "%04X%08X", vendor, hash);
  return {"Lumifield", "Virtual", serial, guid};
}

}  // namespace lumifield::virtual_bench::usb3
