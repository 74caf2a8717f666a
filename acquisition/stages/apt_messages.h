#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "luminaire/geometry.h"

namespace lumifield {

/// Messages of the Thorlabs APT protocol, in bytes and out of them. Pure; value types.
///
/// A message has a header of 6 bytes, little endian: its number (u16), two parameters (u8, u8), destination, source;
/// where data follow, their length (u16) stands in place of the parameters and the destination has its top bit set.
/// Sources: Thorlabs Motion Controllers Host-Controller Communications Protocol, issues 15 to 25; yaq-project
/// thorlabs-apt-protocol; pyLabLib, Thorlabs/kinesis.py (scales).

enum class AptId : std::uint16_t {
  hw_req_info = 0x0005,
  hw_get_info = 0x0006,
  hw_stop_updates = 0x0012,
  hw_response = 0x0080,       ///< a fault that the controller tells unasked
  hw_rich_response = 0x0081,  ///< the same with a text
  set_channel_enabled = 0x0210,
  set_velocity = 0x0413,
  req_velocity = 0x0414,
  get_velocity = 0x0415,
  req_home_params = 0x0441,
  get_home_params = 0x0442,
  move_home = 0x0443,
  homed = 0x0444,
  move_absolute = 0x0453,
  move_completed = 0x0464,
  move_stop = 0x0465,
  move_stopped = 0x0466,
  resume_end_of_move = 0x046c,
  req_status = 0x0480,  ///< steppers
  get_status = 0x0481,
  req_dc_status = 0x0490,  ///< servos
  get_dc_status = 0x0491,
  ack_status = 0x0492,  ///< that the host lives: without it a controller stops telling its status after 50 messages
};

inline constexpr std::uint8_t apt_host = 0x01, apt_rack = 0x11, apt_first_bay = 0x21, apt_unit = 0x50;

struct AptMessage {
  AptId id;
  std::uint8_t param1 = 0, param2 = 0;  ///< of a message without data
  std::uint8_t destination = apt_unit, source = apt_host;
  std::vector<std::uint8_t> data = {};  ///< empty: none
};

std::vector<std::uint8_t> encode(const AptMessage& message);

/// Puts the bytes of a line together to messages for the host. What cannot begin one is dropped, byte by byte.
class AptReader {
 public:
  void append(const std::vector<std::uint8_t>& bytes) { bytes_.insert(bytes_.end(), bytes.begin(), bytes.end()); }
  /// The next message that is complete.
  std::optional<AptMessage> next();
  std::size_t bytes_dropped() const { return dropped_; }

 private:
  std::vector<std::uint8_t> bytes_;
  std::size_t dropped_ = 0;
};

/// Of HW_GET_INFO.
struct AptHardware {
  std::uint32_t serial = 0;
  std::string model, firmware;
  int channels = 0;  ///< bays, of a rack
};
std::optional<AptHardware> parse_apt_hardware(const AptMessage& message);

/// Of MOVE_COMPLETED, MOVE_STOPPED and the status messages, of servos and steppers alike.
struct AptStatus {
  std::int32_t position = 0;
  std::uint32_t bits = 0;

  // The sources name the two directions of a pair the opposite way round.
  bool at_limit() const { return (bits & 0xf) != 0; }
  bool moving() const { return (bits & 0x2f0) != 0; }  ///< moving, jogging or homing
  bool homed() const { return (bits & 0x400) != 0; }
  bool motion_error() const { return (bits & 0x4000) != 0; }
  bool over_current() const { return (bits & 0x1000000) != 0; }
  bool enabled() const { return (bits & 0x80000000) != 0; }
};
std::optional<AptStatus> parse_apt_status(const AptMessage& message);

/// Of GET_VELPARAMS, in the controller's words.
struct AptVelocity {
  std::int32_t least = 0, acceleration = 0, most = 0;
};
std::optional<AptVelocity> parse_apt_velocity(const AptMessage& message);
/// The velocity of GET_HOMEPARAMS, in the controller's words.
std::optional<std::int32_t> parse_apt_home_velocity(const AptMessage& message);

/// Data of the messages that are sent. The channel is 1 in every unit and every bay.
std::vector<std::uint8_t> apt_position_data(std::int32_t counts);
std::vector<std::uint8_t> apt_velocity_data(const AptVelocity& velocity);

/// A family's words for 1 count/s and 1 count/s².
struct AptScale {
  double velocity, acceleration;
};
/// "kdc101" | "bbd30x" | "bsc20x" of AptSettings::controller.
std::optional<AptScale> apt_scale(const std::string& controller);
/// AptSettings::controller of a model, as the hardware names itself; empty where it is not known.
std::string apt_controller(const std::string& model);

}  // namespace lumifield
