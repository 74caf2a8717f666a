#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "acquisition/virtual/stage_server.h"
#include "acquisition/virtual/usb_bus.h"
#include "luminaire/error.h"
#include "luminaire/geometry.h"

namespace lumifield::virtual_bench {

struct AptOptions {
  /// A pair of servo controllers (KDC101), two bays of a stepper controller (BSC202) or of a servo controller (BBD302).
  enum class Kind { pair, stepper_rack, servo_rack } kind = Kind::pair;
  Vec2 travel_mm{200, 150};
  double rapid_mm_s = 200;  ///< at power-up; the host may set others
  double acceleration_mm_s2 = 2000;
  double homing_mm_s = 100;
  double most_mm_s = 1e4;        ///< what the host asks beyond is not taken
  Vec2 power_up_mm{20, 20};      ///< where the carriage truly stands when the controllers start
  bool tells_completion = true;  ///< by MOVE_COMPLETED
};

/// Thorlabs controllers of a two-axis stage on the virtual USB bus, as AptOptions::Kind says.
///
///     standing ── MOVE_HOME ──▶ homing ── MOVE_HOMED ──▶ standing      MOVE_STOP: any ──▶ braking ── MOVE_STOPPED ──▶
///     standing ── MOVE_ABSOLUTE ──▶ moving ── MOVE_COMPLETED ──▶ standing                              standing
///     a limit switch closes: stands, its bit set until homed; nothing is told unasked
///     motion error (servo): stands, its bit set and the channel disabled until homed
///
/// A servo reports where its carriage truly is, counted from where it was homed, a stepper where it believes to be.
/// After 50 status messages that the host does not acknowledge no more are sent. Unplugged, the controllers go on with
/// what they do: they have their own power. Own thread; the members may be called from any.
/// Source: Thorlabs Motion Controllers Host-Controller Communications Protocol.
class AptController final : public StageServer {
 public:
  /// `prepare` gets the true position that both axes will end at, a few milliseconds after a move was begun.
  /// Errors: those of the bus.
  static Result<std::unique_ptr<AptController>> start(UsbBus& bus, const AptOptions& options,
                                                      std::function<void(const Vec2&)> prepare = {});
  ~AptController() override;

  /// As a bench file names them: AptSettings::controller.
  const char* controller() const;
  /// Of the units on USB, and of the kind's motors.
  std::vector<std::string> serials() const;
  double counts_per_mm() const;

  Vec2 true_position_mm() const override;
  Vec2 off_mm() const override;
  void lose_steps(double mm_per_move) override;  ///< a servo's reading shows it
  void set_backlash(double mm) override;         ///< a servo's reading shows it
  void stick(bool stuck) override;
  void silence(bool silent) override;
  void trip_limit() override;  ///< of the x axis
  Status unplug(bool out) override;
  void trip_motion_error();  ///< of the x axis
  /// What is sent from now on arrives so much later.
  void delay(std::chrono::milliseconds by);
  /// The x axis's unit sends this unasked.
  void say(const std::vector<std::uint8_t>& bytes);

 private:
  struct Impl;
  explicit AptController(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace lumifield::virtual_bench
