#include "acquisition/cameras/aravis_camera.h"

#include <algorithm>
#include <arpa/inet.h>
#include <array>
#include <arv.h>
#include <atomic>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <memory>
#include <netinet/in.h>
#include <thread>
#include <unistd.h>

#include "acquisition/virtual/gige_camera.h"
#include "tests/support/camera_test.h"
#include "tests/support/own_network.h"

namespace lumifield {
namespace {

using testing::HasSubstr;

constexpr const char* address = "127.0.0.1";
constexpr int width = 128, height = 96;

/// Aravis' simulated camera with its built-in description: Mono8, Mono16, Bayer8, software trigger. Each photosite
/// tells frame number, exposure and place.
class GigeDouble {
 public:
  explicit GigeDouble(double lost_ratio = 0, double trigger_hz = 1000, const char* description = nullptr)
      : server_(
            ARV_GV_FAKE_CAMERA(g_object_new(ARV_TYPE_GV_FAKE_CAMERA, "interface-name", address, "serial-number", "D1",
                                            "gvsp-lost-ratio", lost_ratio, "genicam-filename", description, nullptr))) {
    EXPECT_TRUE(arv_gv_fake_camera_is_running(server_));
    camera_ = arv_gv_fake_camera_get_fake_camera(server_);
    arv_fake_camera_write_register(camera_, ARV_FAKE_CAMERA_REGISTER_SENSOR_WIDTH, width);
    arv_fake_camera_write_register(camera_, ARV_FAKE_CAMERA_REGISTER_SENSOR_HEIGHT, height);
    arv_fake_camera_set_trigger_frequency(camera_, trigger_hz);
    arv_fake_camera_set_fill_pattern(camera_, fill, &frames_);
  }
  ~GigeDouble() { kill(); }
  GigeDouble(const GigeDouble&) = delete;
  GigeDouble& operator=(const GigeDouble&) = delete;

  void kill() {
    if (server_ != nullptr) g_object_unref(std::exchange(server_, nullptr));
  }
  void set_heartbeat_timeout(int ms) { arv_fake_camera_write_register(camera_, 0x0938, static_cast<guint32>(ms)); }
  void drop_controller() { arv_fake_camera_set_control_channel_privilege(camera_, 0); }
  int frames() const { return frames_; }

  static std::uint16_t dn(int frame, unsigned exposure_us, std::size_t i, int bits) {
    return static_cast<std::uint16_t>((frame * 7919u + exposure_us * 31u + i * 3u) & ((1u << bits) - 1));
  }

 private:
  static void fill(ArvBuffer* buffer, void* frames, guint32 exposure_us, guint32, ArvPixelFormat format) {
    const int frame = ++*static_cast<std::atomic<int>*>(frames);
    std::size_t size = 0;
    auto* bytes = static_cast<std::uint8_t*>(const_cast<void*>(arv_buffer_get_data(buffer, &size)));
    const bool wide = format == ARV_PIXEL_FORMAT_MONO_16;
    for (std::size_t i = 0; i < std::size_t(width) * height; ++i) {
      const std::uint16_t value = dn(frame, exposure_us, i, wide ? 16 : 8);
      bytes[wide ? 2 * i : i] = static_cast<std::uint8_t>(value);
      if (wide) bytes[2 * i + 1] = static_cast<std::uint8_t>(value >> 8);
    }
  }

  ArvGvFakeCamera* server_;
  ArvFakeCamera* camera_;
  std::atomic<int> frames_ = 0;
};

class AravisCamera : public test::CameraTest {
 protected:
  static void SetUpTestSuite() {
    static const bool once = enter_own_network();
    if (!once) GTEST_LOG_(INFO) << "no network namespace: on the machine's own 127.0.0.1";
  }

  static CameraSettings settings(const std::string& format = "Mono16") {
    CameraSettings settings;
    settings.address = address;
    settings.pixel_format = format;
    return settings;
  }
};

void expect_frame(const RawImage& image, int frame, unsigned exposure_us) {
  ASSERT_EQ(image.width_px, width);
  ASSERT_EQ(image.height_px, height);
  ASSERT_EQ(image.dn.size(), std::size_t(width) * height);
  int wrong = 0;
  for (std::size_t i = 0; i < image.dn.size(); ++i)
    wrong += image.dn[i] != GigeDouble::dn(frame, exposure_us, i, image.bits);
  EXPECT_EQ(wrong, 0) << "frame " << frame;
  EXPECT_DOUBLE_EQ(image.exposure_s, exposure_us * 1e-6);
}

TEST_F(AravisCamera, FramesAreBitExactAndNewerThanTheirTrigger) {
  GigeDouble server;
  const auto camera = open(settings());
  ASSERT_NE(camera, nullptr);
  EXPECT_EQ(camera->info().vendor, "Aravis");
  EXPECT_EQ(camera->info().serial, "D1");
  EXPECT_EQ(camera->info().sensor_width_px, width);
  EXPECT_EQ(camera->info().sensor_height_px, height);
  std::uint64_t last_id = 0;
  for (int k = 0; k < 200; ++k) {  // the double's frame ids wrap after 135
    const unsigned exposure_us = 1000 + 100 * (k % 4);
    const int before = server.frames();
    const Result<RawImage> image = camera->expose(exposure_us * 1e-6);
    ASSERT_TRUE(image) << image.error().message();
    ASSERT_EQ(server.frames(), before + 1);
    expect_frame(*image, before + 1, exposure_us);
    EXPECT_NE(image->frame_id, last_id);
    last_id = image->frame_id;
  }
  EXPECT_EQ(camera->frames_retaken(), 0);
}

/// The built-in description in which no feature has that name.
std::string description_without(const std::string& feature) {
  ArvFakeCamera* camera = arv_fake_camera_new("D0");
  std::size_t size = 0;
  const char* text = arv_fake_camera_get_genicam_xml(camera, &size);
  std::string description(text, size);
  g_object_unref(camera);
  const std::string name = "Name=\"" + feature + "\"";
  const std::size_t at = description.find(name);
  EXPECT_NE(at, std::string::npos);
  if (at != std::string::npos) description.replace(at, name.size(), "Name=\"None\"");
  return description;
}

/// A description in a file, as the double reads it.
class DescriptionFile {
 public:
  explicit DescriptionFile(const std::string& description)
      : file_(std::filesystem::path(testing::TempDir()) / ("camera_" + std::to_string(getpid()) + ".xml")) {
    std::ofstream(file_) << description;
  }
  ~DescriptionFile() { std::filesystem::remove(file_); }
  const char* name() const { return file_.c_str(); }

 private:
  std::filesystem::path file_;
};

TEST_F(AravisCamera, MayRefuseToStopWhileIdle) {
  const DescriptionFile file(description_without("AcquisitionStop"));
  GigeDouble server(0, 1000, file.name());
  const auto camera = open(settings());
  ASSERT_NE(camera, nullptr);
  EXPECT_EQ(camera->info().serial, "D1");
  EXPECT_TRUE(camera->expose(0.002));
}

TEST_F(AravisCamera, WhatItRefusesWhilePacketsAreSoughtIsTold) {
  CameraSettings finding = settings();
  finding.packet_bytes = 0;
  for (const auto& [missing, what] : {std::pair("TriggerSoftware", "does not take a software trigger ("),
                                      {"AcquisitionStart", "does not take a start of the acquisition ("},
                                      {"AcquisitionStop", "does not take a stop of the acquisition ("}}) {
    const DescriptionFile file(description_without(missing));
    GigeDouble server(0, 1000, file.name());
    EXPECT_THAT(refusal(finding), HasSubstr(what));
  }
  GigeDouble server(1);
  EXPECT_THAT(refusal(finding), HasSubstr("no frame arrives complete, whatever the size of its packets"));
}

TEST_F(AravisCamera, WithoutBinningIsTakenAsItIs) {
  const DescriptionFile file(description_without("BinningHorizontal"));
  GigeDouble server(0, 1000, file.name());
  EXPECT_NE(open(settings()), nullptr);
  CameraSettings binned = settings();
  binned.binning = 2;
  EXPECT_THAT(refusal(binned), HasSubstr("has no binning to set; set \"binning\": 1"));
}

TEST_F(AravisCamera, TakesFormatAndGainFromTheSettings) {
  GigeDouble server;
  const struct {
    const char* name;
    int bits;
    SensorPattern pattern;
  } formats[] = {
      {"Mono8", 8, SensorPattern::mono}, {"BayerRG8", 8, SensorPattern::rggb}, {"Mono16", 16, SensorPattern::mono}};
  for (const auto& format : formats) {
    CameraSettings with_gain = settings(format.name);
    with_gain.gain = 3;
    const auto camera = open(with_gain);
    ASSERT_NE(camera, nullptr);
    const Result<RawImage> image = camera->expose(0.002);
    ASSERT_TRUE(image) << image.error().message();
    EXPECT_EQ(image->bits, format.bits);
    EXPECT_EQ(image->pattern, format.pattern);
    EXPECT_EQ(image->gain, 0) << "it counts in a unit of its own";
    expect_frame(*image, server.frames(), 2000);
  }
}

TEST_F(AravisCamera, RefusesWhatTheCameraDoesNotTake) {
  GigeDouble server;
  EXPECT_THAT(refusal(settings("Mono12")),
              testing::AllOf(HasSubstr("\"Mono12\""), HasSubstr("Mono8"), HasSubstr("Mono16")));
  EXPECT_THAT(
      refusal(settings("YUV422_8")),
      testing::AllOf(HasSubstr("\"YUV422_8\" sums of colours for screens: no measurement"), HasSubstr("BayerRG8")));
  CameraSettings loud = settings();
  loud.gain = 11;
  EXPECT_THAT(refusal(loud), HasSubstr("from 0 to 10 ("));
  loud.gain = 2.5;
  EXPECT_THAT(refusal(loud), HasSubstr("took a gain of")) << "the double's gain is an integer";
  CameraSettings crumbs = settings();
  crumbs.packet_bytes = 10;
  EXPECT_THAT(refusal(crumbs), HasSubstr("too small"));
}

TEST_F(AravisCamera, PacketsLargerThanTheCamerasLargestAreCut) {
  GigeDouble server;
  CameraSettings large = settings();
  large.packet_bytes = 65000;
  const auto camera = open(large);
  ASSERT_NE(camera, nullptr);
  const Result<RawImage> image = camera->expose(0.001);
  ASSERT_TRUE(image) << image.error().message();
  expect_frame(*image, server.frames(), 1000);
}

TEST_F(AravisCamera, RefusesExposuresOutOfRange) {
  GigeDouble server;
  const auto camera = open(settings());
  ASSERT_NE(camera, nullptr);
  for (const double exposure_s : {0., -1., 1e-6, 11., 1e300, double(NAN)})
    EXPECT_THAT(refusal(*camera, exposure_s), HasSubstr("from 1e-05 to 10 s")) << exposure_s;
  EXPECT_TRUE(camera->expose(1e-5)) << "the range itself is allowed";
}

TEST_F(AravisCamera, RetakesIncompleteFrames) {
  g_random_set_seed(5);
  GigeDouble server(0.03);
  const auto camera = open(settings());
  ASSERT_NE(camera, nullptr);
  for (int k = 0; k < 30; ++k) {
    const Result<RawImage> image = camera->expose(0.001);
    ASSERT_TRUE(image) << image.error().message();
    expect_frame(*image, server.frames(), 1000);
  }
  EXPECT_GT(camera->frames_retaken(), 0);
  EXPECT_EQ(server.frames(), 30 + camera->frames_retaken());
}

TEST_F(AravisCamera, LateFramesNeverPassForLaterOnes) {
  GigeDouble server(0, 2);  // frames come up to 0.5 s after their trigger; the watchdog fires after 0.3 s
  CameraSettings impatient = settings();
  impatient.readout_s = 0;
  const auto camera = open(impatient);
  ASSERT_NE(camera, nullptr);
  for (int k = 0; k < 4; ++k) {
    const unsigned exposure_us = 1000 * (k % 2 + 1);
    const Result<RawImage> image = camera->expose(exposure_us * 1e-6);
    ASSERT_TRUE(image) << image.error().message();
    expect_frame(*image, server.frames(), exposure_us);
  }
}

TEST_F(AravisCamera, AFrameGivenUpIsNoAnswerToALaterTrigger) {
  // Each photosite tells the stage's x at the start of its exposure. The image of the first place takes 1.5 s.
  std::atomic<int> x = 1;
  auto server = virtual_bench::GigeCamera::start(
      {}, {.stage_mm = [&] { return Vec2(x, 0); },
           .wait_ready =
               [](const Vec2& at) {
                 if (at.x() == 1) std::this_thread::sleep_for(std::chrono::milliseconds(1500));
               },
           .expose =
               [](const virtual_bench::Exposure& exposure, std::span<std::uint16_t> dn) {
                 std::ranges::fill(dn, static_cast<std::uint16_t>(exposure.stage_mm.x()));
               }});
  ASSERT_TRUE(server) << server.error().message();
  const auto camera = open(settings("Mono12"));
  ASSERT_NE(camera, nullptr);
  ASSERT_FALSE(camera->expose(0.001));
  x = 2;
  for (int frames = 0, tries = 0; frames < 3; ++tries) {
    ASSERT_LT(tries, 50);
    const Result<RawImage> image = camera->expose(0.001);
    if (!image) continue;  // still busy with what it was asked before
    ASSERT_EQ(image->dn.front(), 2) << "of the place that was left";
    ++frames;
  }
}

TEST_F(AravisCamera, NoFrameFromALivingCamera) {
  GigeDouble server(1);
  const auto camera = open(settings());
  ASSERT_NE(camera, nullptr);
  EXPECT_THAT(refusal(*camera, 0.001), HasSubstr("though the camera answers"));
}

TEST_F(AravisCamera, KilledBetweenFramesIsGone) {
  GigeDouble server;
  const auto camera = open(settings());
  ASSERT_NE(camera, nullptr);
  ASSERT_TRUE(camera->expose(0.001));
  server.kill();
  for (int k = 0; k < 2; ++k) {
    const Result<RawImage> image = camera->expose(0.001);
    ASSERT_FALSE(image);
    EXPECT_THAT(image.error().message(), HasSubstr("camera gone"));
    EXPECT_FALSE(image.error().remedy.empty());
  }
}

TEST_F(AravisCamera, RestartedBetweenFramesIsGoneUntilOpenedAgain) {
  GigeDouble server;
  {
    const auto camera = open(settings());
    ASSERT_NE(camera, nullptr);
    ASSERT_TRUE(camera->expose(0.001));
    server.drop_controller();
    EXPECT_THAT(refusal(*camera, 0.001), HasSubstr("camera gone: it restarted"));
  }
  const auto again = open(settings());
  ASSERT_NE(again, nullptr);
  EXPECT_TRUE(again->expose(0.001));
}

TEST_F(AravisCamera, NobodyAtTheAddress) {
  EXPECT_THAT(refusal(settings()), HasSubstr("the host answers, but no camera on it"));
  CameraSettings nonsense = settings();
  nonsense.address = "no such camera";
  EXPECT_THAT(refusal(nonsense), HasSubstr("camera no such camera: no camera answers"));
}

/// A socket on the GVCP port or towards it.
int udp_socket(bool is_server) {
  sockaddr_in end{};
  end.sin_family = AF_INET;
  end.sin_port = htons(3956);
  end.sin_addr.s_addr = inet_addr(address);
  const int descriptor = socket(AF_INET, SOCK_DGRAM, 0);
  const auto* name = reinterpret_cast<const sockaddr*>(&end);
  EXPECT_EQ(is_server ? bind(descriptor, name, sizeof end) : connect(descriptor, name, sizeof end), 0);
  return descriptor;
}

TEST_F(AravisCamera, SilenceAtTheAddress) {
  const int mute = udp_socket(true);
  EXPECT_THAT(refusal(settings()), HasSubstr("no camera answers"));
  close(mute);
}

TEST_F(AravisCamera, HeldByALivingProgramIsRefused) {
  GigeDouble server;
  const auto owner = open(settings());
  ASSERT_NE(owner, nullptr);
  server.set_heartbeat_timeout(2000);  // Aravis reports every second
  EXPECT_THAT(refusal(settings()), HasSubstr("held by another program"));
  EXPECT_TRUE(owner->expose(0.001)) << "and the owner keeps it";
}

TEST_F(AravisCamera, HeldByADeadProgramIsWaitedFor) {
  GigeDouble server;
  server.set_heartbeat_timeout(1500);  // Aravis reports every second
  const int dead = udp_socket(false);
  const std::array<std::uint8_t, 16> take_control{0x42, 0x01, 0x00, 0x82, 0x00, 0x08, 0, 7, 0, 0, 0x0a, 0, 0, 0, 0, 2};
  ASSERT_EQ(send(dead, take_control.data(), take_control.size(), 0), 16);
  std::array<std::uint8_t, 64> answer;
  ASSERT_GT(recv(dead, answer.data(), answer.size(), 0), 0);
  const auto camera = open(settings());
  ASSERT_NE(camera, nullptr);
  EXPECT_TRUE(camera->expose(0.001));
  close(dead);
}

TEST_F(AravisCamera, IsFoundAndOpenedByItsSerialNumber) {
  GigeDouble server;
  const auto found = find_cameras();
  ASSERT_EQ(found.size(), 1u);
  EXPECT_TRUE(found[0].usable) << found[0].reason;
  EXPECT_EQ(found[0].role, "camera");
  EXPECT_THAT(found[0].name, HasSubstr("D1"));
  EXPECT_EQ(found[0].address, address);
  EXPECT_THAT(found[0].capabilities,
              testing::AllOf(HasSubstr("Mono8"), HasSubstr("Mono16"), HasSubstr("; 128x96 px"),
                             HasSubstr("; gain 0 to 10, not in dB")));

  CameraSettings by_serial = settings();
  by_serial.address = "D1";
  const auto camera = open(by_serial);
  ASSERT_NE(camera, nullptr);
  const auto held = find_cameras();
  ASSERT_EQ(held.size(), 1u);
  EXPECT_FALSE(held[0].usable);
  EXPECT_EQ(held[0].reason, "held by another program");
  EXPECT_FALSE(held[0].remedy.empty());
  EXPECT_EQ(held[0].capabilities, "") << "it was not asked";
  EXPECT_TRUE(camera->expose(0.001));
}

TEST(Cameras, AnUnknownKindListsTheKnownOnes) {
  CameraSettings settings;
  settings.kind = "pinhole";
  const auto camera = open_camera(settings);
  ASSERT_FALSE(camera);
  EXPECT_THAT(camera.error().message(), HasSubstr("\"pinhole\""));
  EXPECT_THAT(camera.error().remedy, HasSubstr("aravis"));
}

}  // namespace
}  // namespace lumifield
