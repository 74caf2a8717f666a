// The production camera, with Aravis' own USB3 Vision, on a virtual one.
#include <algorithm>
#include <arv.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/camera_test.h"
#include "tests/support/usb3_double.h"

namespace lumifield {
namespace {

using testing::AllOf;
using testing::HasSubstr;

class Usb3CameraTest : public test::CameraTest {
 protected:
  void SetUp() override {
    if (!test::can_have_usb_bus()) GTEST_SKIP() << test::why_no_usb_bus;
  }
  static Usb3Double::Options small() { return {.genicam = {.serial = "D1", .width_px = 64, .height_px = 48}}; }
  static std::vector<DeviceReport> found() {
    std::vector<DeviceReport> reports = find_cameras();
    std::erase_if(reports, [](const DeviceReport& report) { return report.name != "Lumifield Virtual D1"; });
    return reports;
  }
  static void expect_exact(Camera& camera, const Usb3Double& double_, double exposure_s) {
    const Result<RawImage> image = camera.expose(exposure_s);
    ASSERT_TRUE(image) << image.error().message();
    EXPECT_EQ(double_.wrong(*image, exposure_s, 0), 0);
  }
};

TEST_F(Usb3CameraTest, IsListedAndOpenedBySerialNumberAndById) {
  Usb3Double double_;
  const std::vector<DeviceReport> listed = found();
  ASSERT_EQ(listed.size(), 1U);
  EXPECT_TRUE(listed[0].usable) << listed[0].reason;
  CameraSettings settings = double_.settings();
  EXPECT_EQ(probe_camera(settings).address, listed[0].address);
  EXPECT_THAT(listed[0].capabilities, AllOf(HasSubstr("Mono12"), HasSubstr("; 64x48 px; exposures of "),
                                            HasSubstr("gain 0 to 24 dB; binning to 4")));
  for (const std::string& name : {std::string("D1"), listed[0].address}) {
    settings.address = name;
    const auto camera = open(settings);
    ASSERT_NE(camera, nullptr);
    EXPECT_EQ(camera->info().vendor, "Lumifield");
    EXPECT_EQ(camera->info().model, "Virtual");
    EXPECT_EQ(camera->info().serial, "D1");
    EXPECT_EQ(camera->info().address, listed[0].address);
    EXPECT_EQ(camera->info().sensor_width_px, 64);
    EXPECT_EQ(camera->info().sensor_height_px, 48);
  }
}

TEST_F(Usb3CameraTest, FramesAreBitExactInEveryFormat) {
  const struct {
    const char* name;
    int bits;
    SensorPattern pattern;
  } formats[] = {{"Mono8", 8, SensorPattern::mono},      {"Mono10p", 10, SensorPattern::mono},
                 {"Mono12", 12, SensorPattern::mono},    {"Mono12p", 12, SensorPattern::mono},
                 {"Mono16", 16, SensorPattern::mono},    {"BayerRG8", 8, SensorPattern::rggb},
                 {"BayerRG12", 12, SensorPattern::rggb}, {"BayerRG12p", 12, SensorPattern::rggb}};
  for (const auto& format : formats) {
    SCOPED_TRACE(format.name);
    Usb3Double::Options options = small();
    options.genicam.pixel_format = format.name;
    Usb3Double double_(options);
    CameraSettings settings = double_.settings();
    settings.gain = 3.5;
    const auto camera = open(settings);
    ASSERT_NE(camera, nullptr);
    const Result<RawImage> image = camera->expose(0.0013);
    ASSERT_TRUE(image) << image.error().message();
    EXPECT_EQ(image->bits, format.bits);
    EXPECT_EQ(image->pattern, format.pattern);
    EXPECT_EQ(image->gain, 3.5);
    EXPECT_EQ(double_.wrong(*image, 0.0013, 3.5), 0);
  }
}

TEST_F(Usb3CameraTest, FramesOfSeveralTransfersAreBitExact) {
  // More than the 1 MiB that Aravis fetches at once: by what is left over, and without a remainder.
  for (const auto& [width, height] : {std::pair(1024, 768), {1024, 1024}}) {
    Usb3Double::Options options = small();
    options.genicam.width_px = width, options.genicam.height_px = height;
    Usb3Double double_(options);
    CameraSettings settings = double_.settings();
    settings.readout_s = 3;  // a large picture takes the double long under a sanitizer
    const auto camera = open(settings);
    ASSERT_NE(camera, nullptr);
    for (int k = 0; k < 5; ++k) expect_exact(*camera, double_, 0.002);
    EXPECT_EQ(camera->frames_retaken(), 0);
  }
}

TEST_F(Usb3CameraTest, WhatSpoilsFramesIsSwitchedOffOrTheCameraRefused) {
  Usb3Double::Options options = small();
  options.genicam.automatics = true;
  {
    Usb3Double double_(options);
    const auto camera = open(double_.settings());
    ASSERT_NE(camera, nullptr);
    expect_exact(*camera, double_, 0.003);
  }
  options.genicam.stuck = {"GainAuto"};
  EXPECT_THAT(refusal(Usb3Double(options).settings()),
              HasSubstr("changes its gain by itself: GainAuto stays Continuous"));
}

TEST_F(Usb3CameraTest, TheWholeRegionIsSetAndReadBackWhateverAnotherProgramLeft) {
  Usb3Double double_;
  {
    ASSERT_EQ(found().size(), 1U);
    ArvCamera* const other = arv_camera_new(found()[0].address.c_str(), nullptr);
    ASSERT_NE(other, nullptr);
    arv_camera_set_region(other, 16, 8, 32, 24, nullptr);
    int width = 0;
    arv_camera_get_region(other, nullptr, nullptr, &width, nullptr, nullptr);
    EXPECT_EQ(width, 32);
    g_object_unref(other);
  }
  const auto camera = open(double_.settings());
  ASSERT_NE(camera, nullptr);
  const Result<RawImage> image = camera->expose(0.001);
  ASSERT_TRUE(image) << image.error().message();
  EXPECT_EQ(image->width_px, 64);
  EXPECT_EQ(double_.wrong(*image, 0.001, 0), 0);
}

TEST_F(Usb3CameraTest, FramesAreNewerThanTheirTrigger) {
  Usb3Double double_;
  const auto camera = open(double_.settings());
  ASSERT_NE(camera, nullptr);
  for (int k = 0; k < 200; ++k) {
    double_.x = k;
    const double exposure_s = 0.001 + 0.0001 * (k % 4);
    const Result<RawImage> image = camera->expose(exposure_s);
    ASSERT_TRUE(image) << image.error().message();
    ASSERT_EQ(double_.wrong(*image, exposure_s, 0), 0) << k;
  }
}

TEST_F(Usb3CameraTest, AFrameGivenUpIsNoAnswerToALaterTrigger) {
  Usb3Double double_;
  const auto camera = open(double_.settings());
  ASSERT_NE(camera, nullptr);
  double_.ready_after_ms = 1500;
  EXPECT_THAT(refusal(*camera, 0.001), HasSubstr("though the camera answers"));
  double_.ready_after_ms = 0;
  double_.x = 2;
  for (int frames = 0, tries = 0; frames < 3; ++tries) {
    ASSERT_LT(tries, 50);
    const Result<RawImage> image = camera->expose(0.001);
    if (!image) continue;  // still busy with what it was asked before
    ASSERT_EQ(double_.wrong(*image, 0.001, 0), 0) << "of the place that was left";
    ++frames;
  }
}

TEST_F(Usb3CameraTest, ATriggerSentAgainGivesNoFrameToALaterOne) {
  Usb3Double::Options options = small();
  options.loses_trigger_answers = true;
  Usb3Double double_(options);
  const auto camera = open(double_.settings());
  ASSERT_NE(camera, nullptr);
  for (int k = 0; k < 8; ++k) {
    SCOPED_TRACE(k);
    expect_exact(*camera, double_, 0.001 + 0.0001 * k);
  }
  EXPECT_GT(double_.server().frames_sent(), 8U);
}

TEST_F(Usb3CameraTest, AFrameThatBeganBeforeItWasAskedForIsNone) {
  Usb3Double::Options options = small();
  options.genicam.repeated_every = 3;
  Usb3Double double_(options);
  const auto camera = open(double_.settings());
  ASSERT_NE(camera, nullptr);
  for (int k = 1; k <= 6; ++k) {
    SCOPED_TRACE(k);
    expect_exact(*camera, double_, 0.05 * k);
  }
}

TEST_F(Usb3CameraTest, FramesThatComeShortAreTakenAgain) {
  Usb3Double::Options options = small();
  options.cut_every = 3;
  Usb3Double double_(options);
  const auto camera = open(double_.settings());
  ASSERT_NE(camera, nullptr);
  for (int k = 0; k < 10; ++k) expect_exact(*camera, double_, 0.001);
  EXPECT_GT(camera->frames_retaken(), 0);
}

TEST_F(Usb3CameraTest, WhenNoWholeFrameComesTheRemedyIsOneForUsb) {
  Usb3Double::Options options = small();
  options.cut_every = 1;
  Usb3Double double_(options);
  const auto camera = open(double_.settings());
  ASSERT_NE(camera, nullptr);
  const auto for_usb = AllOf(HasSubstr("cable"), testing::Not(HasSubstr("network")), testing::Not(HasSubstr("packet")));
  EXPECT_THAT(refusal(*camera, 0.001), AllOf(HasSubstr("6 incomplete frames in a row"), for_usb));
  double_.server().freeze(true);
  EXPECT_THAT(refusal(*camera, 0.001), AllOf(HasSubstr("twice, though the camera answers"), for_usb));
}

TEST_F(Usb3CameraTest, BrokenFramesAreToldWithARemedyForUsb) {
  Usb3Double::Options options = small();
  options.cut_every = 2;
  Usb3Double double_(options);
  Bench bench;
  bench.camera = double_.settings();
  bench.camera_model.width_px = 64, bench.camera_model.height_px = 48;
  const DeviceReport report = try_camera(bench, 3, 0.001);
  EXPECT_TRUE(report.usable) << report.reason;
  EXPECT_THAT(report.reason, HasSubstr("frames came broken"));
  EXPECT_THAT(report.remedy, AllOf(HasSubstr("off its bus"), testing::Not(HasSubstr("net"))));
}

TEST_F(Usb3CameraTest, WhatTheBenchFileAsksForIsLookedForBeforeAnythingIsSet) {
  Usb3Double double_;
  Bench bench;
  bench.camera = double_.settings();
  bench.camera_model.width_px = 32, bench.camera_model.height_px = 24;
  EXPECT_THAT(try_camera(bench, 1, 0.001).reason,
              HasSubstr("gives pictures of 64x48 px, but the bench's camera_model is of 32x24"));
  bench.camera.binning = 16;
  EXPECT_THAT(probe_camera(bench.camera).reason, HasSubstr("a binning of 16x16 is out of its range"));
  bench.camera.pixel_format = "Mono14";
  const DeviceReport report = probe_camera(bench.camera);
  EXPECT_FALSE(report.usable);
  EXPECT_THAT(report.reason, HasSubstr("does not offer the pixel format \"Mono14\""));
  EXPECT_EQ(report.kind, "aravis");
  EXPECT_EQ(report.serial, "D1");
}

TEST_F(Usb3CameraTest, UnpluggedItIsGoneUntilItIsOpenedAgain) {
  Usb3Double double_;
  auto camera = open(double_.settings());
  ASSERT_NE(camera, nullptr);
  ASSERT_TRUE(camera->expose(0.001));
  double_.server().unplug();
  for (int k = 0; k < 2; ++k) EXPECT_THAT(refusal(*camera, 0.001), HasSubstr("camera gone"));
  EXPECT_THAT(refusal(double_.settings()), HasSubstr("no camera answers"));
  ASSERT_TRUE(double_.server().plug());
  EXPECT_THAT(refusal(*camera, 0.001), HasSubstr("camera gone")) << "another device than was opened";
  camera.reset();
  camera = open(double_.settings());
  ASSERT_NE(camera, nullptr);
  expect_exact(*camera, double_, 0.002);
}

TEST_F(Usb3CameraTest, UnpluggedInAnExposureItIsGone) {
  Usb3Double double_;
  const auto camera = open(double_.settings());
  ASSERT_NE(camera, nullptr);
  ASSERT_TRUE(camera->expose(0.001));
  const std::jthread hand([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
    double_.server().unplug();
  });
  EXPECT_THAT(refusal(*camera, 2), HasSubstr("camera gone"));
}

TEST_F(Usb3CameraTest, OneProgramAtATime) {
  Usb3Double double_;
  const auto camera = open(double_.settings());
  ASSERT_NE(camera, nullptr);
  EXPECT_THAT(refusal(double_.settings()), HasSubstr("held by another program"));
  const std::vector<DeviceReport> listed = found();
  ASSERT_EQ(listed.size(), 1U);
  EXPECT_FALSE(listed[0].usable);
  EXPECT_EQ(listed[0].reason, "held by another program");
  EXPECT_TRUE(camera->expose(0.001));
}

TEST_F(Usb3CameraTest, AnIdThatNoCameraHasIsRefused) {
  Usb3Double double_;
  CameraSettings settings = double_.settings();
  settings.address = "Lumifield-Virtual-D2";
  EXPECT_EQ(refusal(settings),
            "camera Lumifield-Virtual-D2: no camera answers; check cable, power and address; "
            "`lumifield devices` lists what answers");
}

}  // namespace
}  // namespace lumifield
