#include "acquisition/cameras/aravis_automatics.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/described_camera.h"

namespace lumifield {
namespace {

/// What Basler's and FLIR's colour cameras do besides the standard.
TEST(AravisAutomatics, MakersOwnColourProcessingIsSwitchedOffToo) {
  DescribedCamera camera(described_choice("BslLightSourcePreset", {"Off", "Daylight5000K"}, "0x8000") +
                         described_choice("BslColorSpace", {"Off", "sRgb"}, "0x8004") +
                         described_choice("BslColorSpaceMode", {"RGB", "sRGB"}, "0x8008"));
  camera.set("BslLightSourcePreset", "Daylight5000K");
  camera.set("BslColorSpace", "sRgb");
  camera.set("BslColorSpaceMode", "sRGB");
  CameraSettings settings;
  settings.address = "Fake_1";
  const Status off = switch_automatics_off(camera.camera(), settings);
  EXPECT_TRUE(off) << off.error().message();
  EXPECT_EQ(camera.text("BslLightSourcePreset"), "Off");
  EXPECT_EQ(camera.text("BslColorSpace"), "Off");
  EXPECT_EQ(camera.text("BslColorSpaceMode"), "RGB");
}

TEST(AravisAutomatics, APresetThatHasNoOffRefusesTheCamera) {
  DescribedCamera camera(described_choice("LightSourcePreset", {"Daylight5000K", "Tungsten2800K"}, "0x8000"));
  CameraSettings settings;
  settings.address = "Fake_1";
  const Status off = switch_automatics_off(camera.camera(), settings);
  ASSERT_FALSE(off);
  EXPECT_THAT(
      off.error().message(),
      testing::HasSubstr("changes colours and response as for a kind of light: LightSourcePreset stays Daylight"));
}

}  // namespace
}  // namespace lumifield
