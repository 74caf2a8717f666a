#include <algorithm>
#include <arv.h>
#include <atomic>
#include <cstdlib>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <memory>

#include "acquisition/cameras/aravis_camera.h"
#include "acquisition/cameras/stream_packets.h"
#include "acquisition/virtual/gige_camera.h"
#include "tests/support/camera_test.h"
#include "tests/support/own_network.h"

namespace lumifield {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using virtual_bench::GigeCamera;

/// Cameras whose photosites all tell one number, and ways to them.
class AravisLinks : public test::CameraTest {
 protected:
  static void SetUpTestSuite() {
    is_own_ = enter_own_network();
    if (!is_own_) return;
    for (const char* address : {"127.0.0.2", "127.0.0.3"}) is_own_ = is_own_ && add_own_address(address);
  }
  void TearDown() override { remember_packets("Lumifield Virtual LF0001 at 127.0.0.1", std::nullopt); }

  std::unique_ptr<GigeCamera> serve(const std::string& address, const std::string& serial, std::uint16_t number) {
    auto server =
        GigeCamera::start({.address = address, .genicam = {.serial = serial, .width_px = 128, .height_px = 96}},
                          {.stage_mm = [] { return Vec2(0, 0); },
                           .wait_ready = [](const Vec2&) {},
                           .expose =
                               [this, number](const virtual_bench::Exposure&, std::span<std::uint16_t> dn) {
                                 ++exposures_;
                                 std::ranges::fill(dn, number);
                               }});
    EXPECT_TRUE(server) << server.error().message();
    return server ? std::move(*server) : nullptr;
  }
  static CameraSettings settings(const std::string& address) {
    CameraSettings settings;
    settings.address = address;
    return settings;
  }
  static int shown(Camera& camera) {
    const Result<RawImage> image = camera.expose(0.002);
    EXPECT_TRUE(image) << image.error().message();
    return image && image->dn.front() == image->dn.back() ? image->dn.front() : -1;
  }

  static inline bool is_own_ = false;
  std::atomic<int> exposures_ = 0;
};

#define NEEDS_OWN_NETWORK() \
  if (!is_own_) GTEST_SKIP() << "needs a network of its own: run as root, or allow user namespaces"

TEST_F(AravisLinks, SeveralCamerasAtOnceAreToldApart) {
  NEEDS_OWN_NETWORK();
  const auto second = serve("127.0.0.2", "L2", 222), third = serve("127.0.0.3", "L3", 333);
  std::vector<std::string> addresses;
  for (const DeviceReport& found : find_cameras())
    if (found.usable && found.name.starts_with("Lumifield Virtual L")) addresses.push_back(found.address);
  EXPECT_THAT(addresses, testing::UnorderedElementsAre("127.0.0.2", "127.0.0.3"));

  const auto by_serial = open(settings("L3")), by_address = open(settings("127.0.0.2"));
  ASSERT_NE(by_serial, nullptr);
  ASSERT_NE(by_address, nullptr);
  EXPECT_EQ(by_serial->info().address, "127.0.0.3") << "opened by its address, whatever it was named by";
  for (int k = 0; k < 10; ++k) {
    EXPECT_EQ(shown(*by_serial), 333);
    EXPECT_EQ(shown(*by_address), 222);
  }
  EXPECT_EQ(by_serial->frames_retaken() + by_address->frames_retaken(), 0);
}

TEST_F(AravisLinks, ById) {
  NEEDS_OWN_NETWORK();
  const auto second = serve("127.0.0.2", "L2", 222), third = serve("127.0.0.3", "L3", 333);
  const auto camera = open(settings("Lumifield-Virtual-L2"));
  ASSERT_NE(camera, nullptr);
  EXPECT_EQ(camera->info().address, "127.0.0.2");
  EXPECT_EQ(shown(*camera), 222);
}

TEST_F(AravisLinks, ANameOfTwoCamerasIsRefused) {
  NEEDS_OWN_NETWORK();
  const auto ours = serve("127.0.0.2", "SAME", 222);
  ArvGvFakeCamera* const other = ARV_GV_FAKE_CAMERA(
      g_object_new(ARV_TYPE_GV_FAKE_CAMERA, "interface-name", "127.0.0.3", "serial-number", "SAME", nullptr));
  EXPECT_THAT(refusal(settings("SAME")),
              AllOf(HasSubstr("is the name of 2 cameras"), HasSubstr("Lumifield-Virtual-SAME at 127.0.0.2"),
                    HasSubstr("Aravis-Fake-SAME at 127.0.0.3"), HasSubstr("give the id or the address")));
  const auto camera = open(settings("Lumifield-Virtual-SAME"));
  ASSERT_NE(camera, nullptr);
  EXPECT_EQ(shown(*camera), 222);
  g_object_unref(other);
}

TEST_F(AravisLinks, TwoOfOneIdAreOpenedByAddress) {
  NEEDS_OWN_NETWORK();
  const auto second = serve("127.0.0.2", "SAME", 222), third = serve("127.0.0.3", "SAME", 333);
  const auto one = open(settings("127.0.0.2")), other = open(settings("127.0.0.3"));
  ASSERT_NE(one, nullptr);
  ASSERT_NE(other, nullptr);
  EXPECT_EQ(shown(*one), 222);
  EXPECT_EQ(shown(*other), 333);
}

TEST_F(AravisLinks, PacketsAreFoundByTestFramesOnce) {
  const auto server = serve("127.0.0.1", "LF0001", 111);
  CameraSettings finding = settings("127.0.0.1");
  finding.packet_bytes = 0;
  for (const int test_frames : {frames_per_try, 0}) {
    exposures_ = 0;
    const auto camera = open(finding);
    ASSERT_NE(camera, nullptr);
    EXPECT_EQ(camera->info().found, "\"packet_bytes\": 16404, \"packet_delay_us\": 0");
    EXPECT_EQ(exposures_, test_frames);
    EXPECT_EQ(shown(*camera), 111);
  }
  const auto given = open(settings("127.0.0.1"));
  ASSERT_NE(given, nullptr);
  EXPECT_EQ(given->info().found, "");
}

/// Lets no packets of more than 5 kB pass, as a switch without jumbo frames does.
class NarrowNetwork {
 public:
  NarrowNetwork() : is_narrow_(run("add dev lo root tbf rate 8gbit burst 5kb limit 64mb")) {}
  ~NarrowNetwork() {
    if (is_narrow_) run("del dev lo root");
  }
  bool is_narrow() const { return is_narrow_; }

 private:
  static bool run(const std::string& what) { return std::system(("tc qdisc " + what + " 2>/dev/null").c_str()) == 0; }
  bool is_narrow_;
};

TEST_F(AravisLinks, PacketsThatDoNotPassAreNotFound) {
  NEEDS_OWN_NETWORK();
  const auto server = serve("127.0.0.1", "LF0001", 111);
  const NarrowNetwork network;
  if (!network.is_narrow()) GTEST_SKIP() << "no tc that may narrow the network: install iproute2";
  CameraSettings finding = settings("127.0.0.1");
  finding.packet_bytes = 0;
  const auto camera = open(finding);
  ASSERT_NE(camera, nullptr);
  EXPECT_THAT(camera->info().found, HasSubstr("\"packet_bytes\": 4096,"));  // with a pause where the machine is busy
  EXPECT_EQ(shown(*camera), 111);
  EXPECT_EQ(camera->frames_retaken(), 0);
}

TEST_F(AravisLinks, FoundPacketsThatPassNoMoreAreFoundAnew) {
  NEEDS_OWN_NETWORK();
  const auto server = serve("127.0.0.1", "LF0001", 111);
  CameraSettings finding = settings("127.0.0.1");
  finding.packet_bytes = 0;
  const auto camera = open(finding);
  ASSERT_NE(camera, nullptr);
  const NarrowNetwork network;
  if (!network.is_narrow()) GTEST_SKIP() << "no tc that may narrow the network: install iproute2";
  EXPECT_THAT(refusal(*camera, 0.002), HasSubstr("6 incomplete frames in a row"));
  EXPECT_EQ(remembered_packets("Lumifield Virtual LF0001 at 127.0.0.1"), std::nullopt);
}

TEST_F(AravisLinks, APauseBetweenPacketsIsSetAndReadBack) {
  const auto server = serve("127.0.0.1", "LF0001", 111);
  CameraSettings paused = settings("127.0.0.1");
  paused.packet_delay_us = 0.5;
  {
    const auto camera = open(paused);
    ASSERT_NE(camera, nullptr);
    EXPECT_EQ(shown(*camera), 111);
  }
  ArvCamera* const bare = arv_camera_new("127.0.0.1", nullptr);
  ASSERT_NE(bare, nullptr);
  EXPECT_EQ(arv_camera_gv_get_packet_delay(bare, nullptr), 500);
  g_object_unref(bare);
  const auto camera = open(settings("127.0.0.1"));
  ASSERT_NE(camera, nullptr);
  EXPECT_EQ(shown(*camera), 111);
}

/// Aravis' camera without a network, as it stands for those on USB: reached by its id, no address, no packets.
class AravisWithoutNetwork : public AravisLinks {
 protected:
  void SetUp() override { arv_enable_interface("Fake"); }
  void TearDown() override { arv_disable_interface("Fake"); }
  static CameraSettings eight_bits(const std::string& name) {
    CameraSettings eight = settings(name);
    eight.pixel_format = "Mono8";
    eight.packet_bytes = 0;
    return eight;
  }
};

TEST_F(AravisWithoutNetwork, IsFoundAndOpenedByItsId) {
  const DeviceReport report = probe_camera(eight_bits("Fake_1"));
  EXPECT_TRUE(report.usable) << report.reason;
  EXPECT_EQ(report.address, "Fake_1");
  const auto camera = open(eight_bits("Fake_1"));
  ASSERT_NE(camera, nullptr);
  EXPECT_EQ(camera->info().vendor, "Aravis");
  EXPECT_EQ(camera->info().address, "Fake_1");
  EXPECT_EQ(camera->info().found, "");
  for (int k = 0; k < 5; ++k) {
    const Result<RawImage> image = camera->expose(0.002);
    ASSERT_TRUE(image) << image.error().message();
    EXPECT_EQ(image->width_px, camera->info().sensor_width_px);
    EXPECT_EQ(image->bits, 8);
  }
}

TEST_F(AravisWithoutNetwork, AWrongIdIsNotThere) {
  EXPECT_THAT(refusal(eight_bits("Fake_7")), HasSubstr("no camera answers"));
  EXPECT_FALSE(probe_camera(eight_bits("Fake_7")).usable);
}

}  // namespace
}  // namespace lumifield
