// Homing, and what the scanner does about steps that the stage lost: scanner.h, "Lost steps".
#include <algorithm>
#include <utility>

#include "acquisition/scan/scanner.h"
#include "acquisition/scan/stretch.h"
#include "luminaire/wording.h"

namespace lumifield {

Status Scanner::home() {
  enter(ScanState::homing);
  came_to_mm_.reset();
  if (end_.stop_requested()) return scan_stopped();
  Stretch moving(clock_, timing_.move_s);
  if (Status status = stage().home(end_.get_token()); !status)
    return blame(Culprit::stage, "homing", std::move(status).error());
  return {};
}

bool Scanner::home_check_due(const std::vector<ScanStep>& steps, std::size_t next) const {
  if (!bench_.stage.check_home || next <= checked_) return false;
  return next == steps.size() || std::holds_alternative<DarkStep>(steps[next]) ||
         std::holds_alternative<SlideStep>(steps[next]);
}

Status Scanner::check_home() {
  if (!bench_.stage.check_home) return {};
  enter(ScanState::moving);
  if (end_.stop_requested()) return scan_stopped();
  came_to_mm_.reset();
  Stretch moving(clock_, timing_.move_s);
  const Result<Vec2> slip_mm = stage().slipped_mm(end_.get_token());
  if (!slip_mm) return blame(Culprit::stage, "home switches", slip_mm.error());
  if (slip_mm->norm() > bench_.tolerance_mm)
    return blame(
        Culprit::slip, "home switches",
        {"the stage has slipped by " + say(*slip_mm) + " mm since it was homed, without its reading telling; " +
             say(bench_.tolerance_mm) + " mm are allowed",
         {},
         "check for a blocked axis and for motors that are driven too fast, then resume: it is homed, and what "
         "was exposed since the last check is taken again"});
  homings_in_a_row_ = 0;
  return {};
}

/// A stage that is homed anew no longer shows where it stood before.
Status Scanner::home_again() {
  if (Status homed = home(); !homed) return homed;
  go_back_ = bench_.stage.check_home;
  return {};
}

/// Takes back what was exposed since the last good check, up to step `next`; the step to go on with.
std::size_t Scanner::go_back(const std::vector<ScanStep>& steps, std::size_t next) {
  go_back_ = false;
  if (next == checked_) return next;
  for (std::size_t k = next; k-- > checked_;) {
    time_left_.insert_step(step_times_s_[k]);
    const auto* step = std::get_if<CellStep>(&steps[k]);
    if (!step) continue;
    --progress_.cells_done;
    std::erase(unchecked_, step->cell);
  }
  // What is left was taken again on the operator's word.
  if (control_) control_->retake(std::exchange(unchecked_, {}));
  dark_due_ = true;
  reference_due_ = reference_read_ && !std::holds_alternative<ReferenceStep>(steps[checked_ + 1]);
  return checked_;
}

/// For the operator of a scan that ends early.
void Scanner::tell_unchecked() {
  if (!bench_.stage.check_home || unchecked_.empty()) return;
  sink_->notice("the home switches were last looked for before cell " + to_string(unchecked_.front()) +
                ": from there to cell " + to_string(unchecked_.back()) +
                " nothing shows that no steps were lost; take these " + std::to_string(unchecked_.size()) +
                " cells again");
}

}  // namespace lumifield
