#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "acquisition/virtual/motion.h"

namespace lumifield::virtual_bench {

/// One axis behind a virtual APT controller: its motor and what the controller says of it, the transport left out. Both
/// forms of the status message have the same place for position and bits. Thread-bound; the owner's clock drives
/// advance().
class AptChannel {
 public:
  using Bytes = std::vector<std::uint8_t>;
  struct Scale {
    double counts_per_mm, velocity, acceleration;  ///< words per count/s and count/s²
  };
  AptChannel(std::uint8_t address, bool is_servo, Scale scale, double power_up_mm, double homing_mm_s,
             double most_mm_s);

  /// Takes a message for this axis, with its header; the answers.
  Bytes take(const Bytes& message);
  /// Goes on for so long; what is told unasked.
  Bytes advance(double seconds);

  void set_speed(double rapid_mm_s, double acceleration_mm_s2);
  void trip_limit();
  void trip_motion_error();

  bool moving() const { return motion_ != Motion::none; }
  double reading_mm() const { return is_servo_ ? motor.true_mm().x() - origin_mm_ : motor.claimed_mm().x(); }
  std::uint8_t address() const { return address_; }

  Axes motor;  ///< along x
  bool tells_completion = true;

 private:
  enum class Motion { none, homing, moving, braking };
  Bytes status(std::uint16_t id);
  void stand();
  void start(Motion motion, double to_mm, double speed_mm_s);

  const std::uint8_t address_;
  const bool is_servo_;
  const Scale scale_;
  const double homing_mm_s_, most_mm_s_;
  std::int32_t speed_word_ = 0, acceleration_word_ = 0;
  double origin_mm_;  ///< where a servo counts from
  Motion motion_ = Motion::none;
  bool homed_ = false, enabled_ = false, at_limit_ = false, motion_error_ = false;
  int unacknowledged_ = 0;
};

/// Little endian.
std::uint32_t get_u32(const AptChannel::Bytes& bytes, std::size_t at);
void put_u16(AptChannel::Bytes& bytes, std::uint16_t value);
void put_u32(AptChannel::Bytes& bytes, std::uint32_t value);

}  // namespace lumifield::virtual_bench
