#pragma once

#include <gtest/gtest.h>
#include <span>
#include <vector>

#include "renderer/opencl/device.h"

namespace lumifield::test {

/// What a kernel without other arguments writes of its structs: so many numbers.
inline std::vector<int> layout_by(const char* source, const char* kernel_name, std::size_t count) {
  auto device = OpenClDevice::create().value();
  auto kernel = device->build(source, "", kernel_name).value();
  std::vector<int> layout(count);
  const auto buffer = device->allocate(layout.size() * sizeof(int), "layout").value();
  kernel.set(0, buffer);
  EXPECT_TRUE(device->run(kernel, 1, 1));
  EXPECT_TRUE(device->read(buffer, std::as_writable_bytes(std::span(layout))));
  return layout;
}

}  // namespace lumifield::test
