#pragma once

#include <gtest/gtest.h>
#include <memory>
#include <string>

#include "acquisition/camera.h"

namespace lumifield::test {

/// Cameras of every kind as tests open and ask them.
class CameraTest : public testing::Test {
 protected:
  static std::unique_ptr<Camera> open(const CameraSettings& settings) {
    auto camera = open_camera(settings);
    EXPECT_TRUE(camera) << camera.error().message();
    return camera ? std::move(*camera) : nullptr;
  }
  static std::string refusal(const CameraSettings& settings) {
    const auto camera = open_camera(settings);
    return camera ? "opened" : camera.error().message();
  }
  static std::string refusal(Camera& camera, double exposure_s) {
    const Result<RawImage> image = camera.expose(exposure_s);
    return image ? "exposed" : image.error().message();
  }
};

}  // namespace lumifield::test
