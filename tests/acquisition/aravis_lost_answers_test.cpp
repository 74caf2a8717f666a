#include <algorithm>
#include <arpa/inet.h>
#include <array>
#include <atomic>
#include <cmath>
#include <cstring>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <linux/capability.h>
#include <memory>
#include <netinet/in.h>
#include <optional>
#include <poll.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <thread>
#include <unistd.h>
#include <vector>

#include "acquisition/cameras/aravis_camera.h"
#include "acquisition/virtual/genicam_registers.h"
#include "acquisition/virtual/gige_camera.h"
#include "tests/support/camera_test.h"
#include "tests/support/own_network.h"

namespace lumifield {
namespace {

using virtual_bench::GigeCamera;

constexpr const char* camera_address = "127.0.0.1";
constexpr const char* relay_address = "127.0.0.2";

sockaddr_in at_gvcp(const char* address) {
  sockaddr_in name{};
  name.sin_family = AF_INET;
  name.sin_port = htons(3956);
  inet_pton(AF_INET, address, &name.sin_addr);
  return name;
}

/// Which answers are lost.
enum class Loss { none, first_of_triggers, all_writes };

/// Stands before a GigE Vision camera, passes its commands and answers, and loses some: at first that to each software
/// trigger: the program sends that command again, and this camera carries it out again.
class AnswerLosingRelay {
 public:
  AnswerLosingRelay() : front_(socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {
    const sockaddr_in here = at_gvcp(relay_address);
    EXPECT_EQ(bind(front_, reinterpret_cast<const sockaddr*>(&here), sizeof here), 0) << std::strerror(errno);
    thread_ = std::jthread([this](std::stop_token stop) { run(stop); });
  }
  ~AnswerLosingRelay() {
    thread_ = {};
    for (const Host& host : hosts_) close(host.back);
    close(front_);
  }
  AnswerLosingRelay(const AnswerLosingRelay&) = delete;
  AnswerLosingRelay& operator=(const AnswerLosingRelay&) = delete;

  int lost() const { return lost_; }
  void lose(Loss loss) { loss_ = loss; }
  /// So many commands are lost from now on.
  void lose_commands(int count) { commands_to_lose_ = count; }

 private:
  struct Host {
    sockaddr_in name;
    int back;  ///< its way to the camera
  };
  using Packet = std::array<std::uint8_t, 2048>;
  static constexpr std::uint16_t write_register = 0x82, write_register_answer = 0x83;  // GigE Vision 1.2, 14

  static constexpr unsigned write_memory_answer = 0x87;
  static bool is_write_answer(unsigned command) {
    return command == write_register_answer || command == write_memory_answer;
  }

  static unsigned number(const Packet& packet, std::size_t at, int bytes) {
    unsigned value = 0;
    for (int k = 0; k < bytes; ++k) value = value << 8 | packet[at + std::size_t(k)];
    return value;
  }

  void run(std::stop_token stop) {
    while (!stop.stop_requested()) {
      std::vector<pollfd> ways{{front_, POLLIN, 0}};
      for (const Host& host : hosts_) ways.push_back({host.back, POLLIN, 0});
      if (poll(ways.data(), ways.size(), 10) <= 0) continue;
      if (ways[0].revents != 0) pass_command();
      for (std::size_t k = 1; k < ways.size(); ++k)
        if (ways[k].revents != 0) pass_answer(hosts_[k - 1]);
    }
  }

  void pass_command() {
    Packet packet{};
    sockaddr_in name{};
    socklen_t size = sizeof name;
    const ssize_t got = recvfrom(front_, packet.data(), packet.size(), 0, reinterpret_cast<sockaddr*>(&name), &size);
    if (got < 12) return;
    if (commands_to_lose_ > 0) {
      --commands_to_lose_;
      return;
    }
    auto host = std::ranges::find_if(hosts_, [&](const Host& each) { return each.name.sin_port == name.sin_port; });
    if (host == hosts_.end()) {
      const sockaddr_in camera = at_gvcp(camera_address);
      const int back = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
      EXPECT_EQ(connect(back, reinterpret_cast<const sockaddr*>(&camera), sizeof camera), 0);
      host = hosts_.insert(hosts_.end(), {name, back});
    }
    const bool triggers =
        number(packet, 2, 2) == write_register && number(packet, 8, 4) == virtual_bench::registers::trigger_software;
    const unsigned id = number(packet, 6, 2);
    if (loss_ == Loss::first_of_triggers && triggers && id != last_trigger_) awaited_ = last_trigger_ = id;
    send(host->back, packet.data(), std::size_t(got), 0);
  }

  void pass_answer(const Host& host) {
    Packet packet{};
    const ssize_t got = recv(host.back, packet.data(), packet.size(), 0);
    if (got < 8) return;
    if (loss_ == Loss::all_writes && is_write_answer(number(packet, 2, 2))) return;
    if (number(packet, 2, 2) == write_register_answer && awaited_ == number(packet, 6, 2)) {
      awaited_.reset();
      ++lost_;
      return;
    }
    sendto(front_, packet.data(), std::size_t(got), 0, reinterpret_cast<const sockaddr*>(&host.name), sizeof host.name);
  }

  int front_;
  std::vector<Host> hosts_;
  std::optional<unsigned> awaited_, last_trigger_;
  std::atomic<int> lost_ = 0;
  std::atomic<int> commands_to_lose_ = 0;
  std::atomic<Loss> loss_ = Loss::first_of_triggers;
  std::jthread thread_;
};

/// While this lives its thread, and those it starts, read frames as an ordinary user's do: through a socket, which
/// takes them from wherever they come, and so from behind the relay.
class WithoutRawSockets {
 public:
  WithoutRawSockets() {
    EXPECT_EQ(syscall(SYS_capget, &header_, before_), 0);
    __user_cap_data_struct data[2] = {before_[0], before_[1]};
    data[0].effective &= ~(1u << CAP_NET_RAW);
    EXPECT_EQ(syscall(SYS_capset, &header_, data), 0);
  }
  ~WithoutRawSockets() { EXPECT_EQ(syscall(SYS_capset, &header_, before_), 0); }

 private:
  __user_cap_header_struct header_{_LINUX_CAPABILITY_VERSION_3, 0};
  __user_cap_data_struct before_[2]{};
};

class AravisLostAnswers : public test::CameraTest {
 protected:
  void SetUp() override {
    if (!enter_own_network() || !add_own_address(relay_address))
      GTEST_SKIP() << "needs a network of its own: run as root, or allow user namespaces";
    settings_.address = relay_address;
    // Each photosite tells the exposure, µs.
    auto server = GigeCamera::start({.genicam = {.width_px = 128, .height_px = 96}},
                                    {.stage_mm = [] { return Vec2(0, 0); },
                                     .wait_ready = [](const Vec2&) {},
                                     .expose =
                                         [](const virtual_bench::Exposure& exposure, std::span<std::uint16_t> dn) {
                                           const long us = std::lround(exposure.exposure_s * 1e6);
                                           std::ranges::fill(dn, static_cast<std::uint16_t>(us));
                                         }});
    ASSERT_TRUE(server) << server.error().message();
    server_ = std::move(*server);
    relay_.emplace();
  }

  CameraSettings settings_;
  std::unique_ptr<GigeCamera> server_;
  std::optional<AnswerLosingRelay> relay_;
};

TEST_F(AravisLostAnswers, ATriggerSentAgainGivesNoFrameToALaterOne) {
  const WithoutRawSockets as_an_ordinary_user;
  const auto camera = open(settings_);
  ASSERT_NE(camera, nullptr);
  for (int k = 0; k < 6; ++k) {
    const int exposure_us = 1000 + 100 * k;
    const Result<RawImage> image = camera->expose(exposure_us * 1e-6);
    ASSERT_TRUE(image) << image.error().message();
    EXPECT_EQ(image->dn.front(), exposure_us);
  }
  EXPECT_EQ(relay_->lost(), 6);
}

TEST_F(AravisLostAnswers, AfterAFailedExposureTheNextIsAsItIsTold) {
  const WithoutRawSockets as_an_ordinary_user;
  const auto camera = open(settings_);
  ASSERT_NE(camera, nullptr);
  relay_->lose(Loss::none);
  const auto shown_us = [&](double exposure_s) {
    const Result<RawImage> image = camera->expose(exposure_s);
    EXPECT_TRUE(image) << image.error().message();
    return image ? image->dn.front() : 0;
  };
  EXPECT_EQ(shown_us(0.0011), 1100);
  relay_->lose(Loss::all_writes);
  EXPECT_THAT(refusal(*camera, 0.05), testing::HasSubstr("does not take an exposure of 0.05 s"));
  relay_->lose(Loss::none);
  EXPECT_EQ(shown_us(0.0011), 1100) << "not 50,000: the exposure was set, and its answer lost";
}

TEST_F(AravisLostAnswers, ACameraThatIsSilentForATimeIsOpenedAllTheSame) {
  relay_->lose_commands(10);  // a look asks five times
  EXPECT_THAT(refusal(settings_), testing::HasSubstr("no camera answers"));
  relay_->lose_commands(6);
  EXPECT_EQ(refusal(settings_), "opened");
}

}  // namespace
}  // namespace lumifield
