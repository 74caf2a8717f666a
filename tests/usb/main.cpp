#include <gtest/gtest.h>
#include <unistd.h>

#include "acquisition/virtual/usb_bus.h"

/// Runs the tests where the virtual USB bus is seen, which takes a start with its library before all others.
int main(int argc, char** argv) {
  using lumifield::virtual_bench::UsbBus;
  constexpr const char* again = "LUMIFIELD_USB_TEST_AGAIN";
  if (!UsbBus::is_preloaded() && getenv(again) == nullptr) {
    setenv(again, "1", 1);
    UsbBus::preload();
    execv("/proc/self/exe", argv);
  }
  testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
