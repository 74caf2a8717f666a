#include "acquisition/virtual/apt_channel.h"

#include <cmath>

namespace lumifield::virtual_bench {

namespace {

constexpr std::uint8_t to_host = 0x01, data_follow = 0x80;
constexpr int most_unacknowledged = 50;
constexpr std::size_t data_at = 6;

std::uint16_t id_of(const AptChannel::Bytes& message) { return std::uint16_t(message[0] | message[1] << 8); }

}  // namespace

std::uint32_t get_u32(const AptChannel::Bytes& bytes, std::size_t at) {
  return std::uint32_t(bytes[at]) | std::uint32_t(bytes[at + 1]) << 8 | std::uint32_t(bytes[at + 2]) << 16 |
         std::uint32_t(bytes[at + 3]) << 24;
}

void put_u16(AptChannel::Bytes& bytes, std::uint16_t value) {
  bytes.push_back(std::uint8_t(value & 0xff)), bytes.push_back(std::uint8_t(value >> 8));
}

void put_u32(AptChannel::Bytes& bytes, std::uint32_t value) {
  put_u16(bytes, std::uint16_t(value & 0xffff)), put_u16(bytes, std::uint16_t(value >> 16));
}

AptChannel::AptChannel(std::uint8_t address, bool is_servo, Scale scale, double power_up_mm, double homing_mm_s,
                       double most_mm_s)
    : motor(Vec2(power_up_mm, 0)),
      address_(address),
      is_servo_(is_servo),
      scale_(scale),
      homing_mm_s_(homing_mm_s),
      most_mm_s_(most_mm_s),
      origin_mm_(power_up_mm) {}

void AptChannel::set_speed(double rapid_mm_s, double acceleration_mm_s2) {
  speed_word_ = std::int32_t(std::lround(rapid_mm_s * scale_.counts_per_mm * scale_.velocity));
  acceleration_word_ = std::int32_t(std::lround(acceleration_mm_s2 * scale_.counts_per_mm * scale_.acceleration));
}

AptChannel::Bytes AptChannel::status(std::uint16_t id) {
  if (++unacknowledged_ > most_unacknowledged) return {};
  Bytes message{std::uint8_t(id & 0xff), std::uint8_t(id >> 8), 14, 0, to_host | data_follow, address_, 1, 0};
  const auto count = [this](double mm) { return std::uint32_t(std::int32_t(std::lround(mm * scale_.counts_per_mm))); };
  put_u32(message, count(reading_mm()));
  put_u32(message, is_servo_ ? std::uint32_t(std::lround(motor.speed_mm_s())) : 0);
  const bool forward = motor.target_mm().x() > motor.claimed_mm().x();
  std::uint32_t bits = 0x100;
  if (at_limit_) bits |= 0x1;
  if (moving()) bits |= forward ? 0x10 : 0x20;
  if (motion_ == Motion::homing) bits |= 0x200;
  if (homed_) bits |= 0x400;
  if (!moving()) bits |= 0x2000;
  if (motion_error_) bits |= 0x4000;
  if (enabled_) bits |= 0x80000000;
  put_u32(message, bits);
  return message;
}

void AptChannel::start(Motion motion, double to_mm, double speed_mm_s) {
  motor.kill();
  motion_ = motion;
  const double acceleration = acceleration_word_ / (scale_.counts_per_mm * scale_.acceleration);
  motor.push({motor.claimed_mm(), Vec2(to_mm, 0), speed_mm_s, acceleration, 0});
}

void AptChannel::stand() {
  motor.kill();
  motion_ = Motion::none;
}

AptChannel::Bytes AptChannel::take(const Bytes& message) {
  switch (id_of(message)) {
    case 0x0210:  // SET_CHANENABLESTATE
      enabled_ = message[3] == 1;
      return {};
    case 0x0413: {  // SET_VELPARAMS
      const auto acceleration = std::int32_t(get_u32(message, data_at + 6));
      const auto speed = std::int32_t(get_u32(message, data_at + 10));
      if (acceleration > 0) acceleration_word_ = acceleration;
      if (speed > 0 && speed <= most_mm_s_ * scale_.counts_per_mm * scale_.velocity) speed_word_ = speed;
      return {};
    }
    case 0x0414: {  // REQ_VELPARAMS
      Bytes told{0x15, 0x04, 14, 0, to_host | data_follow, address_, 1, 0};
      put_u32(told, 0), put_u32(told, std::uint32_t(acceleration_word_)), put_u32(told, std::uint32_t(speed_word_));
      return told;
    }
    case 0x0441: {  // REQ_HOMEPARAMS
      Bytes told{0x42, 0x04, 14, 0, to_host | data_follow, address_, 1, 0, 2, 0, 1, 0};
      put_u32(told, std::uint32_t(std::lround(homing_mm_s_ * scale_.counts_per_mm * scale_.velocity)));
      put_u32(told, 0);
      return told;
    }
    case 0x0443:  // MOVE_HOME
      at_limit_ = motion_error_ = homed_ = false;
      start(Motion::homing, motor.claimed_mm().x() - motor.true_mm().x(), homing_mm_s_);
      return {};
    case 0x0453: {  // MOVE_ABSOLUTE
      if (!enabled_ || at_limit_ || motion_error_) return {};
      const double asked_mm = std::int32_t(get_u32(message, data_at + 2)) / scale_.counts_per_mm;
      start(Motion::moving, asked_mm, speed_word_ / (scale_.counts_per_mm * scale_.velocity));
      return {};
    }
    case 0x0465:  // MOVE_STOP
      if (!moving()) return {};
      motion_ = Motion::braking;
      if (message[3] == 1) motor.kill();
      motor.hold();
      return {};
    case 0x0480:
    case 0x0490:  // REQ_STATUSUPDATE, REQ_DCSTATUSUPDATE
      return is_servo_ == (id_of(message) == 0x0490) ? status(is_servo_ ? 0x0491 : 0x0481) : Bytes();
    case 0x0492:  // ACK_DCSTATUSUPDATE
      unacknowledged_ = 0;
      return {};
    default:
      return {};
  }
}

AptChannel::Bytes AptChannel::advance(double seconds) {
  motor.advance(seconds);
  if (motion_ == Motion::braking && motor.held()) {
    stand();
    return status(0x0466);
  }
  if (!moving() || motion_ == Motion::braking || !motor.empty()) return {};
  const bool was_homing = motion_ == Motion::homing;
  stand();
  if (!was_homing) return tells_completion ? status(0x0464) : Bytes();
  motor.stands_at(Vec2::Zero(), Vec2::Zero());
  origin_mm_ = 0;
  homed_ = true;
  return {0x44, 0x04, 1, 0, to_host, address_};
}

void AptChannel::trip_limit() {
  stand();
  at_limit_ = true;
}

void AptChannel::trip_motion_error() {
  stand();
  motion_error_ = true;
  enabled_ = false;
}

}  // namespace lumifield::virtual_bench
