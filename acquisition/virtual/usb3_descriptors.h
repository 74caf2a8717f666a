#pragma once

#include <array>
#include <string>

#include "acquisition/virtual/usb_device.h"

namespace lumifield::virtual_bench {

/// A USB3 Vision camera as the bus sees it: a control interface, which names the camera's GUID, and a streaming one.
/// Sources: USB 3.2 chapter 9; AIA USB3 Vision 1.0, by the codes and offsets of Aravis' headers. The vendor is that of
/// pid.codes, the product its number for tests.
namespace usb3 {

inline constexpr std::uint8_t answers = 0x81, commands = 0x01, frames = 0x82;

UsbDescription describe(const std::string& serial);
/// Vendor, model, serial number, GUID.
std::array<std::string, 4> strings(const std::string& serial);

}  // namespace usb3
}  // namespace lumifield::virtual_bench
