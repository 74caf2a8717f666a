// What the scanner does when a step fails: scanner.h, "Troubles".
#include <cmath>
#include <utility>

#include "acquisition/scan/scan_rules.h"
#include "acquisition/scan/scanner.h"
#include "acquisition/scan/stretch.h"
#include "luminaire/wording.h"

namespace lumifield {

namespace {

/// A camera that was switched off and on is back within this.
constexpr double patience_s = 60, between_tries_s = 0.2;
/// Of one step: a camera that fails at once each time is not helped by opening it again.
constexpr int most_reconnections = 5;
/// A stage that loses steps each time is not helped by homing it.
constexpr int most_homings = 3;

}  // namespace

tl::unexpected<Error> Scanner::blame(Culprit culprit, std::string_view place, Error error) {
  culprit_ = culprit;
  return fail_in(place, std::move(error));
}

/// Does it, again after every trouble that could be helped, unless the scan has to go back first.
Status Scanner::persist(const std::function<Status()>& action) {
  for (int reconnections = 0;;) {
    Status status = reference_due_ && !dark_due_ ? read_reference() : Status{};
    if (status) status = action();
    if (status) return status;
    if (Status helped = help(std::move(status).error(), reconnections); !helped) return helped;
    if (go_back_) return {};
  }
}

/// The error, when nothing could be done about it.
Status Scanner::help(Error error, int& reconnections) {
  const Culprit culprit = std::exchange(culprit_, Culprit::none);
  if (error.kind == ErrorKind::stopped || end_.stop_requested()) return tl::unexpected(std::move(error));
  if (culprit == Culprit::camera && error.kind != ErrorKind::refused && recovery_ &&
      ++reconnections <= most_reconnections) {
    Status back = reconnect(error);
    if (back || back.error().kind == ErrorKind::stopped) return back;
    error = std::move(back).error();
  }
  const bool attended = control_ && control_->attended();
  if (culprit == Culprit::slip && !attended && homings_in_a_row_ < most_homings) {
    ++homings_in_a_row_;
    sink_->notice(error.where + ": " + error.what +
                  "; it is homed, and what was exposed since the last check is taken again");
    return home_again();
  }
  if (culprit == Culprit::none || !attended) return tl::unexpected(std::move(error));
  reconnections = 0;
  return hold(std::move(error), culprit);
}

/// Tells the progress at every try: somebody watches the time.
Status Scanner::reconnect(const Error& error) {
  Stretch lost(clock_, timing_.lost_s);
  sink_->notice(error.where + ": " + error.what + "; it is waited for up to " + say(patience_s) + " s" +
                (error.remedy.empty() ? "" : ": " + error.remedy));
  const double begin_s = clock_.now_s(), first_step_s = first_step_s_;
  // What is left of the scan's own time does not run down meanwhile.
  const auto count_away_s = [&] {
    first_step_s_ = first_step_s + clock_.now_s() - begin_s;
    return clock_.now_s() - begin_s;
  };
  for (;;) {
    count_away_s();
    enter(ScanState::reconnecting);
    const Status opened = recovery_->reopen_camera();
    const double away_s = count_away_s();
    if (opened) {
      ++cameras_lost_;
      sink_->notice(error.where + ": " + error.what + "; it is back after " + say(std::round(10 * away_s) / 10) +
                    " s and " + progress_.place + " is taken again");
      return {};
    }
    if (away_s >= patience_s)
      return fail_in(progress_.place, {"did not come back within " + say(patience_s) + " s: " + opened.error().what,
                                       opened.error().where, opened.error().remedy});
    if (!clock_.wait(between_tries_s, end_.get_token())) return scan_stopped();
  }
}

/// Waits for the operator's word, until the culprit is back too.
Status Scanner::hold(Error error, Culprit culprit) {
  stage().halt();
  for (;;) {
    progress_.trouble = error.message();
    control_->pause();
    const Status word = await_operator();
    progress_.trouble.clear();
    if (!word) return word;
    Status back = bring_back(culprit, error);
    if (back || back.error().kind == ErrorKind::stopped) return back;
    error = std::move(back).error();
    if (culprit_ != Culprit::none) culprit = std::exchange(culprit_, Culprit::none);  // what failed since
  }
}

/// Until the word to go on: the reference cell is then read before anything else.
Status Scanner::await_operator() {
  {
    Stretch paused(clock_, timing_.paused_s);
    enter(ScanState::paused);
    const double before_s = clock_.now_s();
    control_->wait_while_paused(end_.get_token());
    first_step_s_ += clock_.now_s() - before_s;
  }
  if (end_.stop_requested()) return scan_stopped();
  reference_due_ = reference_read_;
  return {};
}

Status Scanner::bring_back(Culprit culprit, const Error& error) {
  if (culprit == Culprit::lamp) drift_seen_ = drift().drift();
  if (culprit == Culprit::unsteady_lamp) {
    stabilisation_due_ = false;
    return {};
  }
  if (culprit == Culprit::slip) return home_again();
  if (culprit == Culprit::slide) return change_slide();
  if (!recovery_ || culprit == Culprit::lamp || error.kind == ErrorKind::refused) return {};
  if (culprit == Culprit::camera) return reconnect(error);
  if (Status opened = recovery_->reopen_stage(); !opened) return opened;
  return bench_.stage.home ? home_again() : Status{};
}

Status Scanner::read_reference() {
  return take(ReferenceStep{reference_target_mm(bench_, plan_, slide_.value_or(0)),
                            progress_.cells_done - progress_.cells_before});
}

Status Scanner::check_drift(const ReferenceReading& reading, const std::string& place) {
  if (!drift_seen_) drift_seen_ = reading.drift;
  const double further = reading.drift - *drift_seen_;
  if (std::abs(further) <= plan_.reference.limit) return {};
  // A cell that stands elsewhere shows another light.
  if (Status held = check_home(); !held) return held;
  return blame(Culprit::lamp, place,
               {"the light has drifted by " + say(std::round(1e4 * reading.drift) / 100) + " %, the plan allows " +
                    say(100 * plan_.reference.limit) + " %",
                {},
                "check lamp, filter and covers; go on if the drift may stay, which every cell records (without a "
                "window: --accept-drift)",
                ErrorKind::waiting});
}

}  // namespace lumifield
