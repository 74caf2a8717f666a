// What the scanner waits for before the first cell: scanner.h, "Stabilisation".
#include <algorithm>
#include <cmath>
#include <utility>

#include "acquisition/scan/scanner.h"
#include "luminaire/wording.h"

namespace lumifield {

namespace {

constexpr double look_for_pause_s = 0.1;  ///< while the next one is waited for

std::string percent(double share) { return say(std::round(1e5 * share) / 1000) + " %"; }

}  // namespace

Status Scanner::stabilise(const ReferenceStep& step, const std::string& place) {
  if (!plan_.stabilisation || !stabilisation_due_) return {};
  const Status watched = watch_lamp(step, place);
  progress_.stabilisation.reset();
  if (watched) stabilisation_due_ = false;
  return watched;
}

Status Scanner::watch_lamp(const ReferenceStep& step, const std::string& place) {
  const Stabilisation& wanted = *plan_.stabilisation;
  LampStability lamp(wanted);
  double begin_s = clock_.now_s();
  for (;;) {
    if (control_ && control_->paused()) {
      if (Status word = await_operator(); !word) return word;
      lamp = LampStability(wanted);
      begin_s = clock_.now_s();
      continue;
    }
    const double reading_s = clock_.now_s();
    const Result<double> signal = reference_signal(step, place);
    if (!signal) return tl::unexpected(signal.error());
    const double now_s = clock_.now_s(), watched_s = now_s - begin_s;
    lamp.add(now_s, *signal);
    const double left_s = std::max(0.0, wanted.limit_s - watched_s);
    progress_.stabilisation = {*signal, lamp.spread(), wanted.within, left_s, wanted.limit_s};
    enter(ScanState::stabilising);
    if (lamp.steady() || (left_s == 0 && lamp.judges())) return judge(lamp, watched_s, place);
    if (Status waited = wait_for_reading(reading_s + wanted.over_s / readings_over); !waited) return waited;
    // What is left of the scan's own time does not run down meanwhile.
    first_step_s_ += clock_.now_s() - reading_s;
  }
}

/// Until it is due, or the operator pauses.
Status Scanner::wait_for_reading(double due_s) {
  while (!(control_ && control_->paused())) {
    const double left_s = due_s - clock_.now_s();
    if (left_s <= 0) break;
    if (Status waited = wait(std::min(left_s, look_for_pause_s)); !waited) return waited;
  }
  return {};
}

/// The verdict on a lamp that is steady, or that time has run out for.
Status Scanner::judge(const LampStability& lamp, double watched_s, const std::string& place) {
  const Stabilisation& wanted = *plan_.stabilisation;
  stabilised_ = StabilisationEnd{watched_s, *lamp.spread(), lamp.steady()};
  if (stabilised_->steady) return {};
  const std::string what = "the lamp is not steady after " + say(std::round(watched_s)) + " s: its light spreads by " +
                           percent(stabilised_->spread) + " over " + say(wanted.over_s) + " s, the plan allows " +
                           percent(wanted.within);
  if (accepts_unsteady_) {
    sink_->notice(place + ": " + what + "; the scan goes on, as its drift is accepted");
    return {};
  }
  return blame(Culprit::unsteady_lamp, place,
               {what,
                {},
                "check lamp and supply, and stop and start again to wait on; or go on with the lamp as it is, which is "
                "recorded (without a window: --accept-drift)",
                ErrorKind::waiting});
}

/// Each reading chooses its exposure anew: a lamp may become much brighter.
Result<double> Scanner::reference_signal(const ReferenceStep& step, const std::string& place) {
  const Result<Standing> lit = bracket_at(step.stage_mm, place, Exposures::plan);
  if (!lit) return tl::unexpected(lit.error());
  ReferenceDrift alone;
  const auto reading = read_light(alone, lit->bracket, step, place);
  if (!reading) return tl::unexpected(reading.error());
  return reading->signal_dn_per_s;
}

}  // namespace lumifield
