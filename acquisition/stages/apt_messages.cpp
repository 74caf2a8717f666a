#include "acquisition/stages/apt_messages.h"

namespace lumifield {
namespace {

constexpr std::size_t header_bytes = 6, most_data_bytes = 255;
constexpr std::uint8_t data_follow = 0x80;
constexpr std::uint16_t channel = 1;

template <class T>
void put(std::vector<std::uint8_t>& bytes, T value) {
  for (std::size_t k = 0; k < sizeof value; ++k)
    bytes.push_back(static_cast<std::uint8_t>(static_cast<std::make_unsigned_t<T>>(value) >> (8 * k)));
}

template <class T>
T get(const std::vector<std::uint8_t>& bytes, std::size_t at) {
  std::make_unsigned_t<T> value = 0;
  for (std::size_t k = 0; k < sizeof value; ++k)
    value = static_cast<decltype(value)>(value | static_cast<decltype(value)>(bytes[at + k]) << (8 * k));
  return static_cast<T>(value);
}

bool is_source(std::uint8_t byte) {
  return byte == apt_unit || byte == apt_rack || (byte >= apt_first_bay && byte < apt_first_bay + 10);
}

}  // namespace

std::vector<std::uint8_t> encode(const AptMessage& message) {
  std::vector<std::uint8_t> bytes;
  put(bytes, static_cast<std::uint16_t>(message.id));
  if (message.data.empty()) {
    put(bytes, message.param1), put(bytes, message.param2), put(bytes, message.destination);
  } else {
    put(bytes, static_cast<std::uint16_t>(message.data.size()));
    put(bytes, static_cast<std::uint8_t>(message.destination | data_follow));
  }
  put(bytes, message.source);
  bytes.insert(bytes.end(), message.data.begin(), message.data.end());
  return bytes;
}

std::optional<AptMessage> AptReader::next() {
  while (bytes_.size() >= header_bytes) {
    const bool has_data = (bytes_[4] & data_follow) != 0;
    const std::size_t length = has_data ? get<std::uint16_t>(bytes_, 2) : 0;
    if ((bytes_[4] & ~data_follow) != apt_host || !is_source(bytes_[5]) || length > most_data_bytes) {
      bytes_.erase(bytes_.begin());
      ++dropped_;
      continue;
    }
    if (bytes_.size() < header_bytes + length) return std::nullopt;
    AptMessage message{AptId{get<std::uint16_t>(bytes_, 0)}, 0, 0, apt_host, bytes_[5], {}};
    if (!has_data) message.param1 = bytes_[2], message.param2 = bytes_[3];
    const auto end = bytes_.begin() + static_cast<std::ptrdiff_t>(header_bytes + length);
    message.data.assign(bytes_.begin() + header_bytes, end);
    bytes_.erase(bytes_.begin(), end);
    return message;
  }
  return std::nullopt;
}

std::optional<AptHardware> parse_apt_hardware(const AptMessage& message) {
  if (message.id != AptId::hw_get_info || message.data.size() < 84) return std::nullopt;
  AptHardware hardware;
  hardware.serial = get<std::uint32_t>(message.data, 0);
  for (std::size_t k = 4; k < 12 && message.data[k] >= ' ' && message.data[k] < 127; ++k)
    hardware.model += static_cast<char>(message.data[k]);
  for (std::size_t k = 16; k >= 14; --k)  // minor, interim, major
    hardware.firmware += std::to_string(message.data[k]) + (k > 14 ? "." : "");
  hardware.channels = get<std::uint16_t>(message.data, 82);
  return hardware;
}

std::optional<AptStatus> parse_apt_status(const AptMessage& message) {
  using enum AptId;
  if (message.id != move_completed && message.id != move_stopped && message.id != get_status &&
      message.id != get_dc_status)
    return std::nullopt;
  if (message.data.size() < 14) return std::nullopt;
  return AptStatus{get<std::int32_t>(message.data, 2), get<std::uint32_t>(message.data, 10)};
}

std::optional<AptVelocity> parse_apt_velocity(const AptMessage& message) {
  if (message.id != AptId::get_velocity || message.data.size() < 14) return std::nullopt;
  return AptVelocity{get<std::int32_t>(message.data, 2), get<std::int32_t>(message.data, 6),
                     get<std::int32_t>(message.data, 10)};
}

std::optional<std::int32_t> parse_apt_home_velocity(const AptMessage& message) {
  if (message.id != AptId::get_home_params || message.data.size() < 14) return std::nullopt;
  return get<std::int32_t>(message.data, 6);
}

std::vector<std::uint8_t> apt_position_data(std::int32_t counts) {
  std::vector<std::uint8_t> data;
  put(data, channel), put(data, counts);
  return data;
}

std::vector<std::uint8_t> apt_velocity_data(const AptVelocity& velocity) {
  std::vector<std::uint8_t> data;
  put(data, channel), put(data, velocity.least), put(data, velocity.acceleration), put(data, velocity.most);
  return data;
}

std::optional<AptScale> apt_scale(const std::string& controller) {
  // The servos' loops run every T; positions there have 16 more bits.
  const auto servo = [](double T) { return AptScale{65536 * T, 65536 * T * T}; };
  if (controller == "kdc101") return servo(2048 / 6e6);
  if (controller == "bbd30x") return servo(102.4e-6);
  if (controller == "bsc20x") return AptScale{53.68, 53.68 * 204.94e-6};
  return std::nullopt;
}

std::string apt_controller(const std::string& model) {
  constexpr std::pair<std::string_view, const char*> known[] = {
      {"KDC", "kdc101"}, {"TDC", "kdc101"}, {"BBD", "bbd30x"}, {"BSC2", "bsc20x"}};
  for (const auto& [begin, controller] : known)
    if (model.starts_with(begin)) return controller;
  return {};
}

}  // namespace lumifield
