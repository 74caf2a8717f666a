#include "acquisition/cameras/gvcp_probe.h"

#include <algorithm>
#include <arpa/inet.h>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstdint>
#include <netinet/in.h>
#include <optional>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

namespace lumifield {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::uint16_t gvcp_port = 3956;
constexpr int tries = 5;
constexpr std::chrono::milliseconds try_time(100);
constexpr std::uint16_t access_denied = 0x8006;  // status of reads while another program has exclusive access
constexpr std::uint32_t control_privilege_address = 0x0a00, exclusive_or_control = 0x03;
constexpr std::uint32_t heartbeat_timeout_address = 0x0938;
constexpr int first_id = 0x4c00;  // any but 0

class UdpSocket {
 public:
  explicit UdpSocket(const in_addr& host) : descriptor_(socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(gvcp_port);
    address.sin_addr = host;
    // Connected, so that a refusal comes back as an error.
    connected_ = connect(descriptor_, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
  }
  ~UdpSocket() {
    if (descriptor_ >= 0) close(descriptor_);
  }
  UdpSocket(const UdpSocket&) = delete;
  UdpSocket& operator=(const UdpSocket&) = delete;

  int get() const { return descriptor_; }
  bool connected() const { return connected_; }

 private:
  int descriptor_;
  bool connected_ = false;
};

struct Packet {
  std::array<std::uint8_t, 64> bytes;
  ssize_t size = 0;
  std::uint16_t word(int offset) const { return std::uint16_t(bytes[offset] << 8 | bytes[offset + 1]); }
};

struct Reply {
  GvcpPresence presence = GvcpPresence::silent;
  std::uint16_t status = 0;
  std::uint32_t value = 0;  ///< where status is 0
};

/// What the packet says, if it answers request `id`.
std::optional<Reply> parse_reply(const Packet& packet, std::uint16_t id) {
  constexpr std::uint16_t read_register_ack = 0x0081;
  if (packet.size < 8 || packet.word(2) != read_register_ack || packet.word(6) != id) return std::nullopt;
  Reply reply{GvcpPresence::present, packet.word(0), 0};
  if (reply.status == 0 && packet.size < 12) return std::nullopt;
  if (reply.status == 0) reply.value = std::uint32_t(packet.word(8)) << 16 | packet.word(10);
  return reply;
}

/// One request and the wait for its answer; silent when nothing came.
Reply ask(int descriptor, std::uint16_t id, std::uint32_t address) {
  const auto byte = [](std::uint32_t value, int shift) { return static_cast<std::uint8_t>(value >> shift); };
  const std::array<std::uint8_t, 12> request{0x42,
                                             0x01,
                                             0x00,
                                             0x80,
                                             0x00,
                                             0x04,
                                             byte(id, 8),
                                             byte(id, 0),
                                             byte(address, 24),
                                             byte(address, 16),
                                             byte(address, 8),
                                             byte(address, 0)};
  const Reply refusal{GvcpPresence::refused, 0, 0};
  if (send(descriptor, request.data(), request.size(), 0) < 0 && errno == ECONNREFUSED) return refusal;
  const Clock::time_point deadline = Clock::now() + try_time;
  while (true) {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - Clock::now());
    pollfd readable{descriptor, POLLIN, 0};
    if (left.count() <= 0 || poll(&readable, 1, static_cast<int>(left.count())) == 0) return {};
    Packet packet;
    packet.size = recv(descriptor, packet.bytes.data(), packet.bytes.size(), MSG_DONTWAIT);
    if (packet.size < 0 && errno == ECONNREFUSED) return refusal;
    if (const auto reply = parse_reply(packet, id)) return *reply;
  }
}

Reply read_register(const std::string& ipv4_address, std::uint32_t address) {
  in_addr host;
  if (inet_pton(AF_INET, ipv4_address.c_str(), &host) != 1) return {};
  const UdpSocket udp(host);
  if (!udp.connected()) return {};
  Reply reply;
  for (int each = 0; each < tries && reply.presence == GvcpPresence::silent; ++each)
    reply = ask(udp.get(), static_cast<std::uint16_t>(first_id + each), address);
  return reply;
}

}  // namespace

bool is_ipv4_address(const std::string& text) {
  in_addr address;
  return inet_pton(AF_INET, text.c_str(), &address) == 1;
}

GvcpAnswer probe_gvcp(const std::string& ipv4_address) {
  const Reply reply = read_register(ipv4_address, control_privilege_address);
  return {reply.presence, reply.status == access_denied || (reply.value & exclusive_or_control) != 0};
}

std::chrono::milliseconds gvcp_heartbeat_timeout(const std::string& ipv4_address) {
  const Reply reply = read_register(ipv4_address, heartbeat_timeout_address);
  if (reply.value == 0) return std::chrono::seconds(3);
  return std::chrono::milliseconds(std::min<std::uint32_t>(reply.value, 10'000));
}

}  // namespace lumifield
