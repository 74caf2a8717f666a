#pragma once

#include <optional>
#include <vector>

#include "acquisition/scan/scan_plan.h"
#include "acquisition/stage.h"
#include "luminaire/bench.h"
#include "luminaire/plan.h"

namespace lumifield {

/// How fast the stage's axes go, for predictions. Value type.
struct StageSpeed {
  double rapid_mm_s = 10, acceleration_mm_s2 = 50;  ///< defaults where unknown: a slow bench, so that scans end early
};

/// The bench file's speeds; what it leaves at 0 is taken from `reported`.
StageSpeed stage_speed(const StageSettings& settings, const StageSpeed& reported = {});
/// The same for a stage that is open.
StageSpeed stage_speed(const StageSettings& settings, const StageInfo& reported);

/// Time of one point-to-point move: accelerate, cruise, decelerate along the axis that goes farther (both axes are
/// co-ordinated, and it limits).
double move_time_s(const StageSpeed& speed, const Vec2& from_mm, const Vec2& to_mm);

/// Where the stage is sent to come to a target from one side (StageSettings::approach_mm): the target alone when the
/// way from `from_mm` already goes at least that far in that direction along each such axis, else target − approach_mm
/// first. Absent `from_mm`: unknown.
std::vector<Vec2> way_to(const Vec2& target_mm, const Vec2& approach_mm, const std::optional<Vec2>& from_mm);

/// Predicted time of every step: moves with their approaches, settling, exposures, read-outs. Cells count with the
/// plan's exposures, since which of them need others is not known before; dark sets with all that the plan allows. The
/// first step's move is left out, since it starts at an unknown place, and so are homing, looking for the home switches
/// and the operator's time for a slide; the warm-up counts to the first step.
std::vector<double> step_times_s(const std::vector<ScanStep>& steps, const Bench& bench, const Plan& plan,
                                 const StageSpeed& speed);
/// Of all of them.
double scan_time_s(const std::vector<ScanStep>& steps, const Bench& bench, const Plan& plan, const StageSpeed& speed);

/// Time left: the prediction for the steps ahead times the pace so far, which starts at 1 and weighs the prediction
/// with 5 % of the whole. Value type.
class TimeLeft {
 public:
  TimeLeft() = default;
  explicit TimeLeft(std::vector<double> step_times_s);

  /// `spent_s`: since the first step began.
  void step_done(double spent_s);
  /// A step that was not planned comes next.
  void insert_step(double time_s);
  double left_s(double spent_s) const;

 private:
  double pace() const;

  std::vector<double> steps_s_;
  std::size_t next_ = 0;
  double total_s_ = 0, predicted_s_ = 0, spent_s_ = 0;
};

}  // namespace lumifield
