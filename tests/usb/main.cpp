#include <gtest/gtest.h>

#include "acquisition/virtual/usb_bus.h"

/// Runs the tests where the virtual USB bus is seen.
int main(int argc, char** argv) {
  lumifield::virtual_bench::UsbBus::enter(argv);
  testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
