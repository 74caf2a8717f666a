#pragma once

#include <gtest/gtest.h>
#include <memory>

#include "acquisition/virtual/usb_bus.h"

namespace lumifield::test {

inline bool can_have_usb_bus() { return virtual_bench::UsbBus::is_entered(); }
inline constexpr const char* why_no_usb_bus =
    "the program could not be started before umockdev's library: install umockdev";

/// This program's own USB bus.
inline virtual_bench::UsbBus& usb_bus() {
  static const Result<std::unique_ptr<virtual_bench::UsbBus>> bus = virtual_bench::UsbBus::create();
  EXPECT_TRUE(bus) << bus.error().message();
  return **bus;
}

}  // namespace lumifield::test
