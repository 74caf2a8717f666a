#include <arv.h>
#include <cmath>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <memory>
#include <span>

#include "acquisition/cameras/aravis_camera.h"
#include "acquisition/virtual/gige_camera.h"
#include "tests/support/camera_test.h"
#include "tests/support/own_network.h"

namespace lumifield {
namespace {

using testing::AllOf;
using testing::HasSubstr;

constexpr int width = 64, height = 48;

/// Every photosite tells exposure, gain and its place.
std::uint16_t site(std::size_t i, double exposure_s, double gain_db) {
  return static_cast<std::uint16_t>(i * 40503u + std::llround(exposure_s * 1e6) * 31 + std::llround(gain_db * 8));
}

class AravisFormats : public test::CameraTest {
 protected:
  static void SetUpTestSuite() { enter_own_network(); }

  void serve(virtual_bench::GenicamOptions options) {
    server_.reset();
    options.width_px = width, options.height_px = height;
    auto server = virtual_bench::GigeCamera::start(
        {.genicam = options}, {.stage_mm = [] { return Vec2(0, 0); },
                               .wait_ready = [](const Vec2&) {},
                               .expose =
                                   [](const virtual_bench::Exposure& e, std::span<std::uint16_t> dn) {
                                     for (std::size_t i = 0; i < dn.size(); ++i)
                                       dn[i] = site(i, e.exposure_s, e.gain_db);
                                   }});
    ASSERT_TRUE(server) << server.error().message();
    server_ = std::move(*server);
  }
  static CameraSettings settings(const std::string& format) {
    CameraSettings settings;
    settings.address = "127.0.0.1";
    settings.pixel_format = format;
    settings.gain = 2;
    return settings;
  }
  /// Opens a camera, and counts the photosites of a frame that differ.
  static void expect_exact(const std::string& format, int bits, SensorPattern pattern) {
    const auto camera = open(settings(format));
    ASSERT_NE(camera, nullptr) << format;
    const Result<RawImage> image = camera->expose(0.003);
    ASSERT_TRUE(image) << image.error().message();
    EXPECT_EQ(image->bits, bits) << format;
    EXPECT_EQ(image->pattern, pattern) << format;
    ASSERT_EQ(image->dn.size(), std::size_t(width) * height);
    int wrong = 0;
    for (std::size_t i = 0; i < image->dn.size(); ++i)
      wrong += image->dn[i] != (site(i, 0.003, 2) & ((1u << bits) - 1));
    EXPECT_EQ(wrong, 0) << format;
  }

  std::unique_ptr<virtual_bench::GigeCamera> server_;
};

TEST_F(AravisFormats, FramesAreBitExactInEachOfThem) {
  const std::pair<const char*, SensorPattern> families[] = {{"Mono", SensorPattern::mono},
                                                            {"BayerRG", SensorPattern::rggb},
                                                            {"BayerGR", SensorPattern::grbg},
                                                            {"BayerGB", SensorPattern::gbrg},
                                                            {"BayerBG", SensorPattern::bggr}};
  const std::pair<const char*, int> depths[] = {{"8", 8},   {"10", 10},       {"10Packed", 10}, {"10p", 10},
                                                {"12", 12}, {"12Packed", 12}, {"12p", 12},      {"16", 16}};
  for (const auto& [family, pattern] : families)
    for (const auto& [depth, bits] : depths) {
      const std::string format = std::string(family) + depth;
      serve({.pixel_format = format});
      expect_exact(format, bits, pattern);
    }
  serve({.pixel_format = "Mono14"});
  expect_exact("Mono14", 14, SensorPattern::mono);
  for (const char* format : {"RGB8", "BGR8"}) {
    serve({.pixel_format = format});
    expect_exact(format, 8, SensorPattern::rggb);
  }
}

TEST_F(AravisFormats, SwitchesAllAutomaticsOff) {
  for (const auto& [format, pattern] : {std::pair("Mono12", SensorPattern::mono), {"BayerRG12", SensorPattern::rggb}}) {
    serve({.pixel_format = format, .automatics = true});
    expect_exact(format, 12, pattern);
  }
}

TEST_F(AravisFormats, IsMeasuredWithOneGainAndKeepsItsOtherSelectors) {
  serve({.automatics = true});  // DigitalAll and Red are selected
  expect_exact("Mono12", 12, SensorPattern::mono);
  ArvCamera* const bare = arv_camera_new("127.0.0.1", nullptr);
  ASSERT_NE(bare, nullptr);
  EXPECT_STREQ(arv_camera_get_string(bare, "GainSelector", nullptr), "All");
  EXPECT_EQ(arv_camera_get_gain(bare, nullptr), 2);
  arv_camera_set_string(bare, "GainSelector", "DigitalAll", nullptr);
  EXPECT_EQ(arv_camera_get_gain(bare, nullptr), 0);
  EXPECT_STREQ(arv_camera_get_string(bare, "GainAuto", nullptr), "Off");
  EXPECT_STREQ(arv_camera_get_string(bare, "BalanceRatioSelector", nullptr), "Red");
  g_object_unref(bare);
}

TEST_F(AravisFormats, RefusesACameraWhoseAutomaticsStayOn) {
  for (const char* feature : {"ExposureAuto", "GainAuto", "BlackLevelAuto", "BalanceWhiteAuto"}) {
    serve({.automatics = true, .stuck = {feature}});
    EXPECT_THAT(refusal(settings("Mono12")), AllOf(HasSubstr(feature + std::string(" stays Continuous")),
                                                   HasSubstr("; switch it off"), HasSubstr("by itself")));
    serve({.automatics = false, .stuck = {feature}});
    expect_exact("Mono12", 12, SensorPattern::mono);
  }
  serve({.automatics = true, .stuck = {"LUTEnable"}});
  EXPECT_THAT(refusal(settings("Mono12")), HasSubstr("values by a look-up table: LUTEnable stays on"));
}

TEST_F(AravisFormats, RefusesACameraThatStaysAsAnotherProgramLeftIt) {
  const std::pair<const char*, const char*> refusals[] = {
      {"GainAuto", "changes its gain by itself: GainAuto stays Continuous under GainSelector All; switch it off with"},
      {"Gain", "changes values by a second gain: Gain stays 3 dB under GainSelector DigitalAll; set it to 0 dB with"},
      {"BalanceRatio", "a factor of their colour: BalanceRatio stays 1.5 under BalanceRatioSelector Red; set it to 1"},
      {"ReverseX", "sends its frames mirrored, left to right: ReverseX stays on; switch it off"},
      {"ReverseY", "sends its frames mirrored, top to bottom: ReverseY stays on; switch it off"},
      {"ExposureMode", "another time than it is told: ExposureMode stays TriggerWidth; set it to Timed with"}};
  for (const auto& [feature, sentence] : refusals) {
    serve({.automatics = true, .stuck = {feature}});
    EXPECT_THAT(refusal(settings("Mono12")), HasSubstr(sentence));
  }
}

TEST_F(AravisFormats, AGammaIsSwitchedOffOrSetToOne) {
  for (const char* feature : {"GammaEnable", "Gamma"}) {
    serve({.automatics = true, .stuck = {feature}});
    expect_exact("Mono12", 12, SensorPattern::mono);
  }
  serve({.automatics = true, .stuck = {"GammaEnable", "Gamma"}});
  EXPECT_THAT(refusal(settings("Mono12")), HasSubstr("values by a gamma: Gamma stays 0.45"));
}

TEST_F(AravisFormats, ThePictureFollowsTheBinning) {
  serve({});
  for (const int binning : {2, 4, 1}) {  // the camera keeps it from one program to the next
    CameraSettings binned = settings("Mono12");
    binned.binning = binning;
    const auto camera = open(binned);
    ASSERT_NE(camera, nullptr);
    EXPECT_EQ(camera->info().sensor_width_px, width / binning);
    EXPECT_EQ(camera->info().sensor_height_px, height / binning);
    const Result<RawImage> image = camera->expose(0.003);
    ASSERT_TRUE(image) << image.error().message();
    EXPECT_EQ(image->width_px, width / binning);
    EXPECT_EQ(image->height_px, height / binning);
  }
  CameraSettings coarse = settings("Mono12");
  coarse.binning = 5;
  EXPECT_THAT(refusal(coarse), HasSubstr("a binning of 5x5 is out of its range; choose one from 1 to 4"));
}

}  // namespace
}  // namespace lumifield
