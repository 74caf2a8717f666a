#include "acquisition/scan/motion_time.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>
#include <optional>

#include "acquisition/scan/exposure_ladder.h"

namespace lumifield {

namespace {

const std::vector<Vec2>& targets_of(const CellStep& step) { return step.stage_mm; }
std::vector<Vec2> targets_of(const DarkStep& step) { return {step.stage_mm}; }
std::vector<Vec2> targets_of(const ReferenceStep& step) { return {step.stage_mm}; }
std::vector<Vec2> targets_of(const VisitStep& step) { return {step.stage_mm}; }
std::vector<Vec2> targets_of(const SlideStep& step) { return {step.stage_mm}; }

}  // namespace

StageSpeed stage_speed(const StageSettings& settings, const StageSpeed& reported) {
  StageSpeed speed;
  if (reported.rapid_mm_s > 0) speed.rapid_mm_s = reported.rapid_mm_s;
  if (reported.acceleration_mm_s2 > 0) speed.acceleration_mm_s2 = reported.acceleration_mm_s2;
  if (settings.rapid_mm_s > 0) speed.rapid_mm_s = settings.rapid_mm_s;
  if (settings.acceleration_mm_s2 > 0) speed.acceleration_mm_s2 = settings.acceleration_mm_s2;
  return speed;
}

StageSpeed stage_speed(const StageSettings& settings, const StageInfo& reported) {
  return stage_speed(settings, StageSpeed{reported.rapid_mm_s, reported.acceleration_mm_s2});
}

double move_time_s(const StageSpeed& speed, const Vec2& from_mm, const Vec2& to_mm) {
  assert(speed.rapid_mm_s > 0 && speed.acceleration_mm_s2 > 0);
  const double way = (to_mm - from_mm).cwiseAbs().maxCoeff();
  const double v = speed.rapid_mm_s, a = speed.acceleration_mm_s2;
  return way < v * v / a ? 2 * std::sqrt(way / a) : way / v + v / a;
}

std::vector<Vec2> way_to(const Vec2& target_mm, const Vec2& approach_mm, const std::optional<Vec2>& from_mm) {
  bool agrees = true;
  for (int axis : {0, 1}) {
    const double a = approach_mm[axis];
    if (a != 0) agrees = agrees && from_mm && (target_mm[axis] - (*from_mm)[axis]) / a >= 1;
  }
  if (agrees) return {target_mm};
  return {target_mm - approach_mm, target_mm};
}

std::vector<double> step_times_s(const std::vector<ScanStep>& steps, const Bench& bench, const Plan& plan,
                                 const StageSpeed& speed) {
  const auto standing_s = [&](const std::vector<double>& exposures_s) {
    return plan.settle_s + std::accumulate(exposures_s.begin(), exposures_s.end(), 0.0) +
           static_cast<double>(exposures_s.size()) * bench.camera.readout_s;
  };
  const double lit_s = standing_s(plan.exposures_s), dark_s = standing_s(exposure_ladder(plan).exposures_s);

  std::vector<double> times;
  std::optional<Vec2> at;
  for (const ScanStep& step : steps) {
    double time = times.empty() ? plan.warm_up_s : 0;
    for (const Vec2& target : std::visit([](const auto& s) { return std::vector<Vec2>(targets_of(s)); }, step)) {
      const bool visit = std::holds_alternative<VisitStep>(step), dark = std::holds_alternative<DarkStep>(step);
      if (!std::holds_alternative<SlideStep>(step)) time += visit ? plan.settle_s : dark ? dark_s : lit_s;
      for (const Vec2& stop : way_to(target, bench.stage.approach_mm, at)) {
        time += at ? move_time_s(speed, *at, stop) : 0;
        at = stop;
      }
    }
    times.push_back(time);
  }
  return times;
}

double scan_time_s(const std::vector<ScanStep>& steps, const Bench& bench, const Plan& plan, const StageSpeed& speed) {
  const std::vector<double> times = step_times_s(steps, bench, plan, speed);
  return std::accumulate(times.begin(), times.end(), 0.0);
}

TimeLeft::TimeLeft(std::vector<double> step_times_s) : steps_s_(std::move(step_times_s)) {
  total_s_ = std::accumulate(steps_s_.begin(), steps_s_.end(), 0.0);
}

void TimeLeft::step_done(double spent_s) {
  assert(next_ < steps_s_.size());
  predicted_s_ += steps_s_[next_++];
  spent_s_ = spent_s;
}

void TimeLeft::insert_step(double time_s) {
  steps_s_.insert(steps_s_.begin() + static_cast<std::ptrdiff_t>(next_), time_s);
  total_s_ += time_s;
}

double TimeLeft::pace() const {
  const double trust_s = 0.05 * total_s_;
  return predicted_s_ + trust_s > 0 ? (spent_s_ + trust_s) / (predicted_s_ + trust_s) : 1;
}

double TimeLeft::left_s(double spent_s) const {
  return std::max(0.0, (total_s_ - predicted_s_) * pace() - (spent_s - spent_s_));
}

}  // namespace lumifield
