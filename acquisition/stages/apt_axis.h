#pragma once

#include <chrono>
#include <string>

#include "acquisition/stages/apt_unit.h"

namespace lumifield {

/// One axis of an AptStage: a unit, or a bay of one. Lengths are mm of the stage reading, direction applied.
/// Thread-bound, but stop_now().
class AptAxis {
 public:
  using Seconds = std::chrono::duration<double>;

  struct Setup {
    std::string name;  ///< "x"
    std::uint8_t address = apt_unit;
    bool is_stepper = false;
    AptScale scale{1, 1};
    double counts_per_mm = 1, direction = 1, travel_mm = 0;
  };
  AptAxis(AptUnit& unit, Setup setup) : unit_(unit), setup_(std::move(setup)) {}

  /// Enables the channel, sets speeds that are not 0, and reads back what the controller took. Errors: refused.
  Status prepare(double speed_mm_s, double acceleration_mm_s2);
  double speed_mm_s() const { return speed_mm_s_; }
  double acceleration_mm_s2() const { return acceleration_mm_s2_; }

  /// Errors: motion error, not homed, disabled.
  Result<double> ready();
  Result<double> position();

  /// Starts homing; the longest that it may take.
  Result<Seconds> start_home();
  /// Starts a move; how long it will take. Errors: target beyond the travel, those of ready().
  Result<Seconds> start_move(double target_mm);
  /// Goes on watching what was started, for some milliseconds: true when it has ended well.
  Result<bool> watch();
  /// Goes on watching for a stand-still.
  Result<bool> stands();
  /// A profiled stop.
  void stop_now();

  const std::string& serial() const { return unit_.serial(); }

 private:
  using Clock = std::chrono::steady_clock;
  AptMessage message(AptId id, std::uint8_t param1 = 1, std::uint8_t param2 = 0) const;
  AptMessage message(AptId id, std::vector<std::uint8_t> data) const;
  AptMessage status_question() const { return message(setup_.is_stepper ? AptId::req_status : AptId::req_dc_status); }
  AptId status_answer() const { return setup_.is_stepper ? AptId::get_status : AptId::get_dc_status; }
  Result<AptStatus> status();
  double to_mm(std::int32_t counts) const { return setup_.direction * counts / setup_.counts_per_mm; }
  tl::unexpected<Error> trouble(const std::string& what, const std::string& remedy) const;
  tl::unexpected<Error> stopped_short(const AptStatus& status) const;
  /// After an answer, so that nothing of an earlier motion is still to come.
  Status begin(const AptMessage& order, AptId ends_with, double target_mm);
  Status ask_again();
  Result<bool> judge(const AptMessage& message);

  AptUnit& unit_;
  const Setup setup_;
  double speed_mm_s_ = 0, acceleration_mm_s2_ = 0;
  AptId ends_with_ = AptId::move_completed;  ///< the message that ends the motion under way
  double target_mm_ = 0;
  bool ended_ = false;
  Clock::time_point moved_, asked_;  ///< last told or begun; last asked
  int unanswered_ = 0;               ///< requests of a status since the last answer
};

}  // namespace lumifield
