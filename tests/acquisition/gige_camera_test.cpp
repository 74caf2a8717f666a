#include "acquisition/virtual/gige_camera.h"

#include <algorithm>
#include <arv.h>
#include <atomic>
#include <chrono>
#include <cstring>
#include <gtest/gtest.h>
#include <mutex>
#include <net/if.h>
#include <optional>
#include <sched.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <thread>
#include <unistd.h>
#include <vector>

namespace lumifield::virtual_bench {
namespace {

using Clock = std::chrono::steady_clock;

// A network of this process alone, where the kernel allows one: the camera's port is one for the whole machine.
void own_network() {
  if (unshare(CLONE_NEWNET) != 0) return;
  const int any = socket(AF_INET, SOCK_DGRAM, 0);
  ifreq request{};
  std::strcpy(request.ifr_name, "lo");
  ioctl(any, SIOCGIFFLAGS, &request);
  request.ifr_flags |= IFF_UP;
  ioctl(any, SIOCSIFFLAGS, &request);
  close(any);
}

// A world of one formula, in which every setting of an exposure shows in every pixel.
struct FormulaWorld {
  std::mutex mutex;
  Vec2 stage_mm{1.5, 2.25};
  std::vector<Vec2> waited_for;
  std::atomic<int> ready_after_ms = 0;

  void place(const Vec2& at) {
    const std::lock_guard lock(mutex);
    stage_mm = at;
  }
  std::size_t exposures() {
    const std::lock_guard lock(mutex);
    return waited_for.size();
  }

  static void expose(const Exposure& e, std::span<std::uint16_t> dn) {
    const double level = 1e5 * e.exposure_s + 64 * e.stage_mm.x() + 16 * e.stage_mm.y() + 8 * e.gain_db;
    for (int y = 0; y < e.height_px; ++y)
      for (int x = 0; x < e.width_px; ++x)
        dn[std::size_t(y) * std::size_t(e.width_px) + std::size_t(x)] =
            std::uint16_t((int(level) + 3 * (x + e.offset_x_px) + 7 * (y + e.offset_y_px)) & 4095);
  }
  Sight sight() {
    return {.stage_mm =
                [this] {
                  const std::lock_guard lock(mutex);
                  return stage_mm;
                },
            .wait_ready =
                [this](const Vec2& at) {
                  std::this_thread::sleep_for(std::chrono::milliseconds(ready_after_ms.load()));
                  const std::lock_guard lock(mutex);
                  waited_for.push_back(at);
                },
            .expose = &FormulaWorld::expose};
  }
};

// A bare client: what any GigE Vision program does, through Aravis.
class Client {
 public:
  Client() : camera_(arv_camera_new("127.0.0.1", &error_)) { check(); }
  ~Client() {
    if (stream_ != nullptr) {
      arv_camera_stop_acquisition(camera_, nullptr);
      g_object_unref(stream_);
    }
    if (camera_ != nullptr) g_object_unref(camera_);
    g_clear_error(&error_);
  }
  Client(const Client&) = delete;
  Client& operator=(const Client&) = delete;

  ArvCamera* camera() { return camera_; }
  ArvDevice* device() { return arv_camera_get_device(camera_); }

  bool set_format(const char* format) {
    GError* error = nullptr;
    arv_camera_set_pixel_format_from_string(camera_, format, &error);
    const bool taken = error == nullptr;
    g_clear_error(&error);
    return taken;
  }
  void expose_for(double exposure_us, double gain_db) {
    arv_camera_set_exposure_time(camera_, exposure_us, &error_), check();
    arv_camera_set_gain(camera_, gain_db, &error_), check();
  }
  void start() {
    arv_camera_set_trigger(camera_, "Software", &error_), check();
    arv_camera_gv_set_packet_size(camera_, 8192, &error_), check();
    stream_ = arv_camera_create_stream(camera_, nullptr, nullptr, &error_), check();
    g_object_set(stream_, "socket-buffer", ARV_GV_STREAM_SOCKET_BUFFER_FIXED, "socket-buffer-size", 4194304, nullptr);
    const guint payload = arv_camera_get_payload(camera_, &error_);
    check();
    for (int i = 0; i < 4; ++i) arv_stream_push_buffer(stream_, arv_buffer_new(payload, nullptr));
    arv_camera_start_acquisition(camera_, &error_), check();
  }
  void trigger() { arv_camera_software_trigger(camera_, &error_), check(); }

  struct Frame {
    bool complete = false;
    int width_px = 0, height_px = 0;
    ArvPixelFormat format = 0;
    std::vector<std::uint16_t> dn;
  };
  std::optional<Frame> next(double timeout_s) {
    ArvBuffer* buffer = arv_stream_timeout_pop_buffer(stream_, guint64(timeout_s * 1e6));
    if (buffer == nullptr) return std::nullopt;
    const bool complete = arv_buffer_get_status(buffer) == ARV_BUFFER_STATUS_SUCCESS;
    if (!complete) {
      arv_stream_push_buffer(stream_, buffer);
      return Frame{};
    }
    std::size_t bytes = 0;
    const auto* dn = static_cast<const std::uint16_t*>(arv_buffer_get_data(buffer, &bytes));
    Frame frame{true, arv_buffer_get_image_width(buffer), arv_buffer_get_image_height(buffer),
                arv_buffer_get_image_pixel_format(buffer), std::vector(dn, dn + bytes / 2)};
    arv_stream_push_buffer(stream_, buffer);
    return frame;
  }

  /// Triggers until a frame arrives whole: a client without a packet socket loses packets of large frames on a busy
  /// machine, as GigE Vision without resend does.
  std::optional<Frame> trigger_until_complete() {
    std::optional<Frame> frame;
    for (triggers_ = 1; triggers_ <= 8; ++triggers_) {
      trigger();
      frame = next(3);
      if (frame && frame->complete) return frame;
    }
    return frame;
  }
  unsigned triggers() const { return triggers_; }

 private:
  unsigned triggers_ = 0;
  void check() { ASSERT_EQ(error_, nullptr) << error_->message; }
  GError* error_ = nullptr;
  ArvCamera* camera_ = nullptr;
  ArvStream* stream_ = nullptr;
};

class GigeCameraTest : public testing::Test {
 protected:
  static void SetUpTestSuite() { own_network(); }

  void serve(const char* format, double loss = 0, bool automatics = false) {
    camera_.reset();
    auto camera = GigeCamera::start(
        {.lost_packet_ratio = loss, .genicam = {.pixel_format = format, .automatics = automatics}}, world_.sight());
    ASSERT_TRUE(camera) << camera.error().message();
    camera_ = std::move(*camera);
  }
  std::vector<std::uint16_t> expected(Exposure e) const {
    std::vector<std::uint16_t> dn(std::size_t(e.width_px) * std::size_t(e.height_px));
    FormulaWorld::expose(e, dn);
    return dn;
  }

  FormulaWorld world_;
  std::unique_ptr<GigeCamera> camera_;
};

TEST_F(GigeCameraTest, SaysWhoItIsAndOffersItsSensorsFormatOnly) {
  serve("BayerRG12");
  Client client;
  EXPECT_STREQ(arv_camera_get_vendor_name(client.camera(), nullptr), "Lumifield");
  EXPECT_STREQ(arv_camera_get_model_name(client.camera(), nullptr), "Virtual");
  EXPECT_STREQ(arv_camera_get_device_serial_number(client.camera(), nullptr), "LF0001");
  int width = 0, height = 0;
  arv_camera_get_sensor_size(client.camera(), &width, &height, nullptr);
  EXPECT_EQ(width, 1024);
  EXPECT_EQ(height, 768);
  EXPECT_FALSE(client.set_format("Mono12"));
  EXPECT_FALSE(client.set_format("Mono16"));
  EXPECT_TRUE(client.set_format("BayerRG12"));
  double low = 0, high = 0;
  arv_camera_get_exposure_time_bounds(client.camera(), &low, &high, nullptr);
  EXPECT_EQ(low, 10);
  EXPECT_EQ(high, 1e7);
  arv_camera_get_gain_bounds(client.camera(), &low, &high, nullptr);
  EXPECT_EQ(high, 24);
}

TEST_F(GigeCameraTest, DeliversTheWorldsPixelsBitExactly) {
  for (const char* format : {"Mono12", "Mono16", "BayerRG12"}) {
    serve(format);
    Client client;
    ASSERT_TRUE(client.set_format(format));
    client.expose_for(3700, 6.5);
    EXPECT_EQ(arv_camera_get_exposure_time(client.camera(), nullptr), 3700);
    EXPECT_EQ(arv_camera_get_gain(client.camera(), nullptr), 6.5);
    client.start();
    const auto frame = client.trigger_until_complete();
    ASSERT_TRUE(frame);
    EXPECT_TRUE(frame->complete);
    EXPECT_EQ(frame->width_px, 1024);
    EXPECT_EQ(frame->height_px, 768);
    const Exposure exposure{world_.stage_mm, 0.0037, 6.5, 1024, 768, 0, 0};
    EXPECT_TRUE(frame->dn == expected(exposure)) << format;
    EXPECT_EQ(world_.waited_for.back(), world_.stage_mm);
    EXPECT_EQ(camera_->frames_sent(), client.triggers());
  }
}

TEST_F(GigeCameraTest, ReadsOutARegion) {
  serve("Mono12");
  Client client;
  GError* error = nullptr;
  arv_camera_set_region(client.camera(), 100, 40, 640, 480, &error);
  ASSERT_EQ(error, nullptr) << error->message;
  client.expose_for(1000, 0);
  client.start();
  const auto frame = client.trigger_until_complete();
  ASSERT_TRUE(frame);
  EXPECT_EQ(frame->width_px, 640);
  EXPECT_TRUE(frame->dn == expected({world_.stage_mm, 0.001, 0, 640, 480, 100, 40}));
}

TEST_F(GigeCameraTest, AveragesWhatIsBinned) {
  serve("Mono12");
  Client client;
  GError* error = nullptr;
  arv_camera_set_binning(client.camera(), 2, 3, &error);
  ASSERT_EQ(error, nullptr) << error->message;
  int low = 0, high = 0;
  arv_camera_get_width_bounds(client.camera(), &low, &high, nullptr);
  EXPECT_EQ(high, 512);
  arv_camera_set_region(client.camera(), 10, 20, 100, 50, nullptr);
  client.expose_for(1000, 0);
  client.start();
  const auto frame = client.trigger_until_complete();
  ASSERT_TRUE(frame);
  ASSERT_EQ(frame->width_px, 100);
  ASSERT_EQ(frame->height_px, 50);
  const std::vector<std::uint16_t> sites = expected({world_.stage_mm, 0.001, 0, 200, 150, 20, 60});
  for (std::size_t y = 0; y < 50; ++y)
    for (std::size_t x = 0; x < 100; ++x) {
      unsigned sum = 0;
      for (std::size_t k = 0; k < 6; ++k) sum += sites[(3 * y + k / 2) * 200 + 2 * x + k % 2];
      ASSERT_EQ(frame->dn[100 * y + x], sum / 6) << x << ", " << y;
    }
}

TEST_F(GigeCameraTest, EachLeftoverSpoilsTheFrames) {
  const char* const harmless[] = {"ExposureMode=Timed",
                                  "ExposureAuto=Off",
                                  "GainSelector=All GainAuto=Off",
                                  "GainSelector=DigitalAll GainAuto=Off",
                                  "GainSelector=DigitalAll Gain=0",
                                  "BlackLevelAuto=Off",
                                  "BalanceWhiteAuto=Off",
                                  "BalanceRatioSelector=Red BalanceRatio=1",
                                  "BalanceRatioSelector=Blue BalanceRatio=1",
                                  "LUTEnable=false",
                                  "GammaEnable=false",
                                  "ReverseX=false",
                                  "ReverseY=false",
                                  "GainSelector=All"};  // the client's gain, which spoils nothing
  for (const char* left_on : harmless) {
    const bool is_exact = left_on == std::string("GainSelector=All");
    serve("Mono12", 0, true);
    Client client;
    for (const char* setting : harmless) {
      if (setting == left_on && !is_exact) continue;
      GError* error = nullptr;
      arv_device_set_features_from_string(client.device(), setting, &error);
      ASSERT_EQ(error, nullptr) << error->message;
    }
    arv_camera_set_region(client.camera(), 0, 0, 64, 48, nullptr);
    client.expose_for(3000, 1);
    client.start();
    const auto frame = client.trigger_until_complete();
    ASSERT_TRUE(frame);
    EXPECT_EQ(frame->dn == expected({world_.stage_mm, 0.003, 1, 64, 48, 0, 0}), is_exact) << left_on;
  }
}

TEST_F(GigeCameraTest, BoundsTheRegionByTheSensor) {
  serve("Mono12");
  Client client;
  arv_camera_set_region(client.camera(), 100, 40, 640, 480, nullptr);
  int low = 0, high = 0;
  arv_camera_get_width_bounds(client.camera(), &low, &high, nullptr);
  EXPECT_EQ(high, 924);
  arv_camera_get_height_bounds(client.camera(), &low, &high, nullptr);
  EXPECT_EQ(high, 728);
  arv_camera_get_x_offset_bounds(client.camera(), &low, &high, nullptr);
  EXPECT_EQ(high, 384);
  arv_camera_get_y_offset_bounds(client.camera(), &low, &high, nullptr);
  EXPECT_EQ(high, 288);
}

TEST_F(GigeCameraTest, TakesTheStageAtTheStartOfTheExposure) {
  serve("Mono12");
  Client client;
  arv_camera_set_region(client.camera(), 0, 0, 320, 240, nullptr);
  client.expose_for(150000, 0);
  client.start();
  const Vec2 start = world_.stage_mm;
  std::optional<Client::Frame> frame;
  for (int tries = 0; tries < 8 && !(frame && frame->complete); ++tries) {
    world_.place(start);
    const std::size_t exposures = world_.exposures();
    client.trigger();
    // The stage moves as soon as the exposure has taken it.
    for (int k = 0; k < 3000 && world_.exposures() == exposures; ++k)
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    world_.place({9, 9});
    frame = client.next(3);
  }
  ASSERT_TRUE(frame);
  EXPECT_TRUE(frame->dn == expected({start, 0.15, 0, 320, 240, 0, 0}));
}

TEST_F(GigeCameraTest, ExposesForAsLongAsAskedAndAnswersMeanwhile) {
  serve("Mono12");
  Client client;
  client.expose_for(1000, 0);
  client.start();
  client.trigger();
  ASSERT_TRUE(client.next(3));  // the first frame after the start comes on the simulator's 0.1 s grid
  const auto time_of = [&](double exposure_us) {
    client.expose_for(exposure_us, 0);
    const auto begin = Clock::now();
    client.trigger();
    arv_camera_get_exposure_time(client.camera(), nullptr);
    const auto answered = Clock::now();
    EXPECT_TRUE(client.next(3));
    const auto done = Clock::now();
    EXPECT_LT(answered - begin, done - answered);
    return std::chrono::duration<double>(done - begin).count();
  };
  const double time = time_of(200000), longer = time_of(400000);
  EXPECT_GE(time, 0.2);
  EXPECT_GE(longer, 0.4);
  EXPECT_GT(longer, 1.3 * time);
}

TEST_F(GigeCameraTest, WaitsForTheWorld) {
  serve("Mono12");
  world_.ready_after_ms = 300;
  Client client;
  client.expose_for(1000, 0);
  client.start();
  const auto begin = Clock::now();
  client.trigger();
  ASSERT_TRUE(client.next(3));
  EXPECT_GE(Clock::now() - begin, std::chrono::milliseconds(300));
}

TEST_F(GigeCameraTest, TwoTriggersInOneExposureGiveOneFrame) {
  serve("Mono12");
  Client client;
  client.expose_for(200000, 0);
  client.start();
  client.trigger();
  std::this_thread::sleep_for(std::chrono::milliseconds(20));
  client.trigger();
  ASSERT_TRUE(client.next(3));
  EXPECT_FALSE(client.next(0.4));
  client.trigger();
  EXPECT_TRUE(client.next(3));
}

TEST_F(GigeCameraTest, FrozenItTakesTriggersAndSendsNothing) {
  serve("Mono12");
  Client client;
  client.expose_for(1000, 0);
  client.start();
  camera_->freeze(true);
  client.trigger();
  EXPECT_FALSE(client.next(0.4));
  camera_->freeze(false);
  EXPECT_FALSE(client.next(0.2)) << "a swallowed trigger came back";
  client.trigger();
  EXPECT_TRUE(client.next(3));
}

TEST_F(GigeCameraTest, LosesPacketsWhenTold) {
  serve("Mono12", 0.05);
  Client client;
  client.expose_for(1000, 0);
  client.start();
  int broken = 0;
  for (int i = 0; i < 4; ++i) {
    client.trigger();
    const auto frame = client.next(3);
    broken += !frame || !frame->complete;
  }
  EXPECT_GT(broken, 0);
}

TEST_F(GigeCameraTest, SaysThatTheAddressIsHeld) {
  serve("Mono12");
  const auto second = GigeCamera::start({}, world_.sight());
  ASSERT_FALSE(second);
  EXPECT_EQ(second.error().where, "127.0.0.1");
  EXPECT_NE(second.error().what.find("holds UDP port 3956"), std::string::npos) << second.error().message();
}

TEST_F(GigeCameraTest, RefusesWhatCannotBe) {
  EXPECT_FALSE(GigeCamera::start({.address = "no address"}, world_.sight()));
  EXPECT_FALSE(GigeCamera::start({.address = "203.0.113.7"}, world_.sight()));
  EXPECT_FALSE(GigeCamera::start({.genicam = {.pixel_format = "RGB10"}}, world_.sight()));
  EXPECT_FALSE(GigeCamera::start({.genicam = {.serial = "0123456789abcdef"}}, world_.sight()));
}

}  // namespace
}  // namespace lumifield::virtual_bench
