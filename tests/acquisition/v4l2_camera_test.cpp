#include "acquisition/cameras/v4l2_camera.h"

#include <chrono>
#include <cmath>
#include <fcntl.h>
#include <fstream>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <linux/videodev2.h>
#include <sys/fsuid.h>
#include <sys/ioctl.h>
#include <sys/wait.h>
#include <thread>

#include "acquisition/cameras/v4l2_format.h"
#include "acquisition/cameras/v4l2_node.h"
#include "tests/support/camera_test.h"
#include "tests/support/v4l2_double.h"

namespace lumifield {
namespace {

using testing::HasSubstr;
using virtual_bench::V4l2CameraOptions;

class V4l2Camera : public test::CameraTest {
 protected:
  void SetUp() override {
    if (const std::string why = V4l2Double::why_not(); !why.empty()) GTEST_SKIP() << why;
  }
};

TEST_F(V4l2Camera, FramesAreBitExactInEveryFormat) {
  const struct {
    const char* sensor;
    const char* name;
    std::uint32_t fourcc;
    int bits;
    SensorPattern pattern;
  } formats[] = {
      {"Mono12", "Mono12", V4L2_PIX_FMT_Y12, 12, SensorPattern::mono},
      {"Mono12", "Mono12", v4l2_fourcc('Y', '1', '2', 'P'), 12, SensorPattern::mono},
      {"Mono12", "Mono10", V4L2_PIX_FMT_Y10, 10, SensorPattern::mono},
      {"Mono12", "Mono10", V4L2_PIX_FMT_Y10P, 10, SensorPattern::mono},
      {"Mono12", "Mono10", V4L2_PIX_FMT_Y10BPACK, 10, SensorPattern::mono},
      {"Mono12", "Mono8", V4L2_PIX_FMT_GREY, 8, SensorPattern::mono},
      {"Mono12", "YUV422_8", V4L2_PIX_FMT_YUYV, 8, SensorPattern::mono},
      {"Mono16", "Mono16", V4L2_PIX_FMT_Y16, 16, SensorPattern::mono},
      {"BayerRG12", "BayerRG12", V4L2_PIX_FMT_SRGGB12, 12, SensorPattern::rggb},
      {"BayerRG12", "BayerRG12", V4L2_PIX_FMT_SRGGB12P, 12, SensorPattern::rggb},
      {"BayerRG12", "BayerRG10", V4L2_PIX_FMT_SRGGB10, 10, SensorPattern::rggb},
      {"BayerRG12", "BayerRG10", V4L2_PIX_FMT_SRGGB10P, 10, SensorPattern::rggb},
      {"BayerRG12", "BayerRG8", V4L2_PIX_FMT_SRGGB8, 8, SensorPattern::rggb},
  };
  for (const auto& format : formats) {
    SCOPED_TRACE(std::string(format.name) + " as " + std::to_string(format.fourcc));
    V4l2CameraOptions options;
    options.pixel_format = format.sensor;
    options.formats = {format.fourcc};
    V4l2Double double_(options);
    const auto camera = open(double_.settings(format.name));
    ASSERT_NE(camera, nullptr);
    const Result<RawImage> image = camera->expose(0.0013);
    ASSERT_TRUE(image) << image.error().message();
    EXPECT_EQ(image->width_px, V4l2Double::width);
    EXPECT_EQ(image->height_px, V4l2Double::height);
    EXPECT_EQ(image->bits, format.bits);
    EXPECT_EQ(image->pattern, format.pattern);
    EXPECT_EQ(wrong_photosites(*image, 0.0013, 0, 0, double_.bits(), double_.bits() - format.bits), 0);
  }
}

TEST_F(V4l2Camera, TellsWhoItIs) {
  V4l2Double double_;
  const auto camera = open(double_.settings());
  ASSERT_NE(camera, nullptr);
  EXPECT_EQ(camera->info().vendor, "lumifield");
  EXPECT_EQ(camera->info().model, "Virtual");
  EXPECT_EQ(camera->info().serial, "virtual:D1");
  EXPECT_EQ(camera->info().address, double_.path());
  EXPECT_EQ(camera->info().sensor_width_px, V4l2Double::width);
  EXPECT_EQ(camera->info().sensor_height_px, V4l2Double::height);
}

constexpr std::uint32_t automatics[] = {
    V4L2_CID_EXPOSURE_AUTO,          V4L2_CID_AUTOGAIN, V4L2_CID_AUTO_WHITE_BALANCE,
    V4L2_CID_BACKLIGHT_COMPENSATION, V4L2_CID_GAMMA,    V4L2_CID_POWER_LINE_FREQUENCY};

TEST_F(V4l2Camera, AllThatActsByItselfIsSwitchedOff) {
  V4l2Double double_;
  std::map<std::uint32_t, int> before;
  for (const std::uint32_t id : automatics) before[id] = double_.server().control(id);
  const auto camera = open(double_.settings());
  ASSERT_NE(camera, nullptr);
  for (const std::uint32_t id : automatics) {
    const int off = id == V4L2_CID_GAMMA ? 100 : id == V4L2_CID_EXPOSURE_AUTO ? V4L2_EXPOSURE_MANUAL : 0;
    EXPECT_NE(before[id], off) << "it was on";
    EXPECT_EQ(double_.server().control(id), off);
  }
}

TEST_F(V4l2Camera, IsRefusedWhileSomethingActsByItself) {
  for (const std::uint32_t id : automatics) {
    V4l2CameraOptions options;
    options.stubborn = {id};
    V4l2Double double_(options);
    EXPECT_THAT(refusal(double_.settings()),
                testing::AllOf(HasSubstr("does not measure: its "), HasSubstr(" stays at ")));
  }
}

TEST_F(V4l2Camera, TheGainIsThatOfItsControl) {
  V4l2Double double_;
  CameraSettings settings = double_.settings();
  settings.gain = 60;
  {
    const auto camera = open(settings);
    ASSERT_NE(camera, nullptr);
    const Result<RawImage> image = camera->expose(0.001);
    ASSERT_TRUE(image) << image.error().message();
    EXPECT_EQ(image->gain, 0) << "a number of its control is no dB";
    EXPECT_EQ(wrong_photosites(*image, 0.001, 6, 0, 12), 0);
  }
  settings.gain = 241;
  EXPECT_THAT(refusal(settings), HasSubstr("its gain control has no 241; choose a whole number from 0 to 240"));
  settings.gain = 1.5;
  EXPECT_THAT(refusal(settings), HasSubstr("no 1.5"));
  V4l2CameraOptions options;
  options.stubborn = {V4L2_CID_GAIN};
  double_.unplug();
  V4l2Double stubborn(options);
  EXPECT_THAT(refusal(stubborn.settings()), HasSubstr("took a gain of 32 for 0"));
}

TEST_F(V4l2Camera, ExposuresGoInStepsOfItsControl) {
  V4l2Double double_;
  const auto camera = open(double_.settings());
  ASSERT_NE(camera, nullptr);
  const Result<RawImage> image = camera->expose(0.00126);
  ASSERT_TRUE(image) << image.error().message();
  EXPECT_DOUBLE_EQ(image->exposure_s, 0.0013);
  EXPECT_EQ(wrong_photosites(*image, 0.0013, 0, 0, 12), 0);
  for (const double exposure_s : {0., -1., 4e-5, 10.1, 1e300, double(NAN)})
    EXPECT_THAT(refusal(*camera, exposure_s), HasSubstr("from 0.0001 to 10 s")) << exposure_s;
  EXPECT_TRUE(camera->expose(1e-4)) << "the range itself is allowed";
}

TEST_F(V4l2Camera, FormatsAndSizesThatItDoesNotOffer) {
  V4l2Double double_;
  EXPECT_THAT(refusal(double_.settings("MJPG")), testing::AllOf(HasSubstr("is compressed"), HasSubstr("Mono12")));
  EXPECT_THAT(refusal(double_.settings("Mono16")),
              HasSubstr("does not offer the pixel format \"Mono16\"; choose one of Mono12, Mono10, Mono8, YUV422_8"));
  CameraSettings large = double_.settings();
  large.width_px = 640, large.height_px = 480;
  EXPECT_THAT(refusal(large), HasSubstr("does not offer pictures of 640x480 px as Mono12; choose one of 64x48"));
  V4l2CameraOptions options;
  options.formats = {V4L2_PIX_FMT_MJPEG};
  double_.unplug();
  V4l2Double compressed(options);
  EXPECT_THAT(refusal(compressed.settings()), testing::AllOf(HasSubstr("compressed"), HasSubstr("MJPG")));
  EXPECT_FALSE(probe_camera(compressed.settings()).usable);
}

TEST_F(V4l2Camera, NoCameraAtThePath) {
  const V4l2Double double_;
  CameraSettings settings = double_.settings();
  settings.address = "/no/such/device";
  EXPECT_THAT(refusal(settings), HasSubstr("camera /no/such/device: no camera answers: there is no such device"));
  const std::string file = std::string(testing::TempDir()) + "no_camera_" + std::to_string(getpid());
  std::ofstream(file) << "text";
  settings.address = file;
  EXPECT_THAT(refusal(settings), HasSubstr("is no camera: it does not answer as a V4L2 device"));

  std::filesystem::permissions(file, std::filesystem::perms::none);
  const int user = setfsuid(65534);  // root may open anything
  const std::string forbidden = refusal(settings);
  setfsuid(static_cast<uid_t>(user));
  EXPECT_THAT(forbidden,
              testing::AllOf(HasSubstr("no permission to open it"), HasSubstr("usermod -aG"), HasSubstr("udev")));
  std::filesystem::remove(file);
}

TEST_F(V4l2Camera, HeldByAnotherProgramThatIsNamed) {
  V4l2Double double_;
  int told[2], word[2];
  ASSERT_EQ(pipe(told) | pipe(word), 0);
  const std::string path = double_.path();
  const pid_t other = fork();
  if (other == 0) {
    v4l2_requestbuffers request{};
    request.count = 2, request.type = V4L2_BUF_TYPE_VIDEO_CAPTURE, request.memory = V4L2_MEMORY_MMAP;
    const int file = ::open(path.c_str(), O_RDWR);
    const char done = file >= 0 && ioctl(file, VIDIOC_REQBUFS, &request) == 0 ? 'y' : 'n';
    char ignored;
    _exit(write(told[1], &done, 1) == 1 && read(word[0], &ignored, 1) == 1 ? 0 : 1);
  }
  char done = 'n';
  ASSERT_EQ(read(told[0], &done, 1), 1);
  EXPECT_EQ(done, 'y');
  const std::string process = "(process " + std::to_string(other) + ")";
  EXPECT_THAT(refusal(double_.settings()), testing::AllOf(HasSubstr("held by another program: "), HasSubstr(process)));
  const DeviceReport report = probe_camera(double_.settings());
  EXPECT_FALSE(report.usable);
  EXPECT_THAT(report.reason, HasSubstr(process));
  ASSERT_EQ(write(word[1], "x", 1), 1);
  waitpid(other, nullptr, 0);
  EXPECT_EQ(refusal(double_.settings()), "opened");
}

TEST_F(V4l2Camera, IsProbedWithWhatItCan) {
  V4l2Double double_;
  const DeviceReport report = probe_camera(double_.settings());
  EXPECT_TRUE(report.usable) << report.reason;
  EXPECT_EQ(report.role, "camera");
  EXPECT_EQ(report.name, "lumifield Virtual virtual:D1");
  EXPECT_EQ(report.capabilities,
            "Mono12, Mono10, Mono8, YUV422_8; 64x48 px; exposures of 0.0001 to 10 s; gain 0 to 240, not in dB");
  EXPECT_EQ(report.address, double_.path());
  CameraSettings loud = double_.settings(), other = double_.settings();
  loud.gain = 5000, other.pixel_format = "Mono14";
  EXPECT_THAT(probe_camera(loud).reason, HasSubstr("its gain control has no 5000"));
  EXPECT_THAT(probe_camera(other).reason, HasSubstr("does not offer the pixel format \"Mono14\""));
  EXPECT_FALSE(probe_camera(other).usable);
  EXPECT_NE(double_.server().control(V4L2_CID_EXPOSURE_AUTO), V4L2_EXPOSURE_MANUAL) << "nothing is changed";
}

/// Each photosite tells where the stage stood and what the exposure was; the one changes before each frame, in any
/// phase of the camera's own, the other before every other.
void expect_frames_of_their_time(Camera& camera, V4l2Double& double_, int frames) {
  for (int k = 0; k < frames; ++k) {
    std::this_thread::sleep_for(std::chrono::milliseconds(k * 3 % 10));
    double_.x = k;
    const double exposure_s = 0.003 * (1 + k / 2 % 3);
    const Result<RawImage> image = camera.expose(exposure_s);
    ASSERT_TRUE(image) << image.error().message();
    ASSERT_EQ(wrong_photosites(*image, exposure_s, 0, k, 12), 0) << "frame " << k;
  }
}

TEST_F(V4l2Camera, StaleFramesNeverPassForLaterOnes) {
  V4l2Double double_;
  const auto camera = open(double_.settings());
  ASSERT_NE(camera, nullptr);
  expect_frames_of_their_time(*camera, double_, 20);
  std::this_thread::sleep_for(std::chrono::milliseconds(200));  // all buffers are full
  expect_frames_of_their_time(*camera, double_, 2);
  EXPECT_EQ(camera->frames_retaken(), 0);
}

TEST_F(V4l2Camera, ControlsThatActLateAreWaitedFor) {
  V4l2CameraOptions options;
  options.slow_controls = 2;
  V4l2Double double_(options);
  const auto camera = open(double_.settings());
  ASSERT_NE(camera, nullptr);
  expect_frames_of_their_time(*camera, double_, 20);
}

TEST_F(V4l2Camera, FramesHeldBackNeverPassForLaterOnes) {
  V4l2CameraOptions options;
  options.late_frames = 2;  // stamped when they leave
  V4l2Double double_(options);
  CameraSettings settings = double_.settings();
  settings.readout_s = 0.03;  // as the bench file says of such a camera
  const auto camera = open(settings);
  ASSERT_NE(camera, nullptr);
  expect_frames_of_their_time(*camera, double_, 20);
}

TEST_F(V4l2Camera, DamagedAndLostFramesAreCounted) {
  for (const bool damaged : {true, false}) {
    V4l2CameraOptions options;
    (damaged ? options.damaged_every : options.lost_every) = 2;
    V4l2Double double_(options);
    const auto camera = open(double_.settings());
    ASSERT_NE(camera, nullptr);
    expect_frames_of_their_time(*camera, double_, 10);
    EXPECT_GT(camera->frames_retaken(), 0) << (damaged ? "damaged" : "lost");
  }
  V4l2CameraOptions options;
  options.damaged_every = 1;
  V4l2Double double_(options);
  const auto camera = open(double_.settings());
  ASSERT_NE(camera, nullptr);
  EXPECT_THAT(refusal(*camera, 0.001), HasSubstr("6 incomplete frames in a row"));
}

TEST_F(V4l2Camera, PicturesMadeForScreensAreNoMeasurement) {
  V4l2CameraOptions options;
  options.is_for_screens = true;
  const auto said_of = [&](const char* format) {
    V4l2Double double_(options);
    CameraSettings settings = double_.settings();
    settings.pixel_format = format;
    return refusal(settings);
  };
  EXPECT_EQ(said_of("YUV422_8"), "opened") << "its gamma is made 1";
  options.missing = {V4L2_CID_GAMMA};
  EXPECT_THAT(said_of("YUV422_8"), HasSubstr("has no gamma to be set to 1"));
  EXPECT_EQ(said_of("Mono12"), "opened") << "the sensor's own";
}

TEST_F(V4l2Camera, LongExposuresGetALongerFrameInterval) {
  V4l2Double double_;
  const auto camera = open(double_.settings());
  ASSERT_NE(camera, nullptr);
  for (const double exposure_s : {0.001, 0.05, 0.001}) {
    const Result<RawImage> image = camera->expose(exposure_s);
    ASSERT_TRUE(image) << image.error().message();
    EXPECT_EQ(wrong_photosites(*image, exposure_s, 0, 0, 12), 0);
  }
}

TEST_F(V4l2Camera, AfterALongExposureTheFrameIntervalIsItsOwnAgain) {
  V4l2Double double_;
  const auto camera = open(double_.settings());
  ASSERT_NE(camera, nullptr);
  const auto interval_s = [&] {
    const auto node = V4l2Node::open(double_.settings().address);
    EXPECT_TRUE(node);
    return node ? set_frame_interval(*node, 0) : 0;
  };
  const double own_s = interval_s();
  ASSERT_TRUE(camera->expose(0.1));
  EXPECT_NEAR(interval_s(), 0.1, 1e-3);
  ASSERT_TRUE(camera->expose(0.001));
  EXPECT_NEAR(interval_s(), 0.1, 1e-3) << "starting the stream anew would take longer";
  ASSERT_TRUE(camera->expose(0.4));
  const Result<RawImage> image = camera->expose(0.001);
  ASSERT_TRUE(image) << image.error().message();
  EXPECT_EQ(wrong_photosites(*image, 0.001, 0, 0, 12), 0);
  EXPECT_NEAR(interval_s(), own_s, 1e-3);
}

TEST_F(V4l2Camera, TellsHowLongItsFramesAreWaitedFor) {
  V4l2Double double_;
  const auto camera = open(double_.settings());
  ASSERT_NE(camera, nullptr);
  constexpr double own_s = 0.01;  // the double's frame interval
  const auto wait_s = [&](std::vector<double> exposures_s) { return camera->frame_wait_s(exposures_s); };
  EXPECT_NEAR(wait_s({0.005}), 2 * own_s, 1e-9) << "the one that is under way, and the next";
  EXPECT_NEAR(wait_s({0.001, 0.005}), 5 * own_s, 1e-9) << "and those that a change needs";
  EXPECT_NEAR(wait_s({0.001, 0.05}), 5 * 0.05, 1e-9) << "at the interval of the longest";
  EXPECT_NEAR(wait_s({0.001, 1}), (0.4 + 5 * own_s + 5 * 1) / 2, 1e-9) << "or started anew";
}

TEST_F(V4l2Camera, OneThatExposesLessThanItSaysIsRefused) {
  V4l2CameraOptions options;
  options.clips_exposure = true;
  V4l2Double double_(options);
  const auto camera = open(double_.settings());
  ASSERT_NE(camera, nullptr);
  EXPECT_TRUE(camera->expose(0.005));
  EXPECT_THAT(refusal(*camera, 0.05),
              HasSubstr("says that it exposes 0.05 s, but its frames follow each other after 0.0"));
}

TEST_F(V4l2Camera, UnpluggedIsGoneUntilOpenedAgain) {
  V4l2Double double_;
  {
    const auto camera = open(double_.settings());
    ASSERT_NE(camera, nullptr);
    ASSERT_TRUE(camera->expose(0.001));
    double_.unplug();
    for (int k = 0; k < 2; ++k) {
      const Result<RawImage> image = camera->expose(0.001);
      ASSERT_FALSE(image);
      EXPECT_THAT(image.error().message(), HasSubstr("camera gone: "));
      EXPECT_EQ(image.error().remedy, "check cable and power");
    }
    EXPECT_THAT(refusal(double_.settings()), HasSubstr("no camera answers"));
  }
  double_.plug();
  const auto again = open(double_.settings());
  ASSERT_NE(again, nullptr);
  expect_frames_of_their_time(*again, double_, 3);
}

TEST_F(V4l2Camera, UnpluggedWhileAFrameIsAwaitedIsGone) {
  V4l2Double double_;
  const auto camera = open(double_.settings());
  ASSERT_NE(camera, nullptr);
  ASSERT_TRUE(camera->expose(0.001));
  std::jthread hand([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    double_.unplug();
  });
  EXPECT_THAT(refusal(*camera, 5), HasSubstr("camera gone: "));
}

TEST_F(V4l2Camera, NoFrameFromALivingCamera) {
  V4l2Double double_;
  const auto camera = open(double_.settings());
  ASSERT_NE(camera, nullptr);
  double_.server().freeze(true);
  EXPECT_THAT(refusal(*camera, 0.001), HasSubstr("though the camera answers"));
  double_.server().freeze(false);
  expect_frames_of_their_time(*camera, double_, 3);
}

}  // namespace
}  // namespace lumifield
