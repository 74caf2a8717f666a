#pragma once

#include <gtest/gtest.h>
#include <memory>

#include "renderer/opengl/egl_context.h"

namespace lumifield::test {

/// A graphics context; where there is none the test is skipped.
class WithEgl : public testing::Test {
 protected:
  void SetUp() override {
    auto made = EglContext::create();
    if (!made) GTEST_SKIP() << made.error().message();
    context_ = std::move(*made);
  }
  std::unique_ptr<EglContext> context_;
};

}  // namespace lumifield::test
