#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>

#include "acquisition/virtual/stage_server.h"
#include "luminaire/error.h"
#include "luminaire/geometry.h"

namespace lumifield::virtual_bench {

struct GrblOptions {
  std::filesystem::path path;  ///< a symbolic link to the terminal is made here and removed in the end
  Vec2 travel_mm{200, 150};    ///< $130, $131: MPos runs from 0 to these
  double rapid_mm_s = 200;
  double acceleration_mm_s2 = 2000;
  Vec2 power_up_mm{20, 20};                     ///< where the carriage truly stands when the controller starts
  bool soft_limits = true, hard_limits = true;  ///< $20, $21
};

/// A GRBL 1.1 controller of a two-axis stage on a pseudo-terminal, built as HOMING_FORCE_SET_ORIGIN: $H seeks the
/// switches at the low end of both axes, and MPos is 0 where the pull-off ends, so that readings run from 0 to the
/// travel. Work positions are machine positions: no offset can be set. Before homing MPos is 0 wherever the carriage
/// stands.
///
///     Alarm ── $X ──▶ Idle       Alarm, Idle ── $H ──▶ Home ── ok ──▶ Idle
///     Idle ── G0 G1 ──▶ Run ── ! ──▶ Hold:1 ──▶ Hold:0 ── ~ ──▶ Run
///     0x18 in Run, Hold:1: ALARM:3      in Home: ALARM:6      in Idle, Hold:0: Idle, position kept
///     a switch closes: ALARM:1          target beyond the travel: ALARM:2          both dead until 0x18, then Alarm
///
/// With $21=0 a switch that closes is only told by the reports (Pn:), and the carriage goes on for 5 mm to its stop.
/// One switch input per axis serves both ends.
///
/// The planner takes 15 moves and answers `ok` when it takes one; each move accelerates, cruises and ends at rest.
/// There is no jogging. Own thread; the members may be called from any.
class GrblController final : public StageServer {
 public:
  /// `prepare` gets the true position that an accepted move will end at.
  /// Errors: no pseudo-terminal, `path` exists or its folder cannot be written.
  static Result<std::unique_ptr<GrblController>> start(const GrblOptions& options,
                                                       std::function<void(const Vec2&)> prepare = {});
  ~GrblController() override;

  Vec2 true_position_mm() const override;
  Vec2 off_mm() const override;

  void lose_steps(double mm_per_move) override;  ///< MPos does not know
  void set_backlash(double mm) override;         ///< MPos does not know
  void stick(bool stuck) override;
  void silence(bool silent) override;
  void trip_limit() override;        ///< ALARM:1
  Status unplug(bool out) override;  ///< a terminal is not unplugged

 private:
  struct Impl;
  explicit GrblController(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace lumifield::virtual_bench
