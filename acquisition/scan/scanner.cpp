#include "acquisition/scan/scanner.h"

#include <algorithm>
#include <cassert>
#include <span>
#include <utility>

#include "acquisition/scan/scan_rules.h"
#include "acquisition/scan/stretch.h"
#include "luminaire/wording.h"

namespace lumifield {

namespace {

constexpr int attempts = 2;

/// What is to be done is said once, and a scan that was abandoned has no cause of its own.
void add_not_parked(Error& error, const Error& parking) {
  if (error.kind == ErrorKind::stopped)
    error = parking;
  else
    error.remedy += " (the stage could not be parked" +
                    (parking.remedy == error.remedy ? "" : ": " + parking.what + "; " + parking.remedy) + ")";
}

}  // namespace

void ScanSink::seen(const Bracket&, const std::string&, const Vec2&) {}

Scanner::Scanner(Camera& camera, Stage& stage, const Bench& bench, const Plan& plan, BenchClock& clock)
    : camera_(camera), stage_(stage), bench_(bench), plan_(plan), clock_(clock) {}

Status Scanner::run(const ScanPlan& steps, ScanSink& sink, std::stop_token stop, std::stop_token abandon) {
  if (state_ != ScanState::idle)
    return fail("a scan was begun already: " + std::string(to_string(state_)), "scanner", "use a new scanner per scan");
  if (!steps.steps.empty() && !std::holds_alternative<DarkStep>(steps.steps.front()) &&
      !std::holds_alternative<SlideStep>(steps.steps.front()))
    return fail("the first step is not a dark set", "scan plan", "make the plan with make_scan_plan");

  sink_ = &sink;
  steps_ = &steps;
  stop_ = std::move(stop);
  const auto end_now = [this] { end_.request_stop(); };
  const std::stop_callback at_stop(stop_, end_now), at_abandon(abandon, end_now);
  begin_s_ = first_step_s_ = clock_.now_s();
  warm_up_left_s_ = plan_.warm_up_s;
  ladder_ = exposure_ladder(plan_);
  progress_.cells_done = progress_.cells_before = steps.cells_before;
  progress_.cells_total = steps.cells_before + steps.cells;
  step_times_s_ = step_times_s(steps.steps, bench_, plan_, stage_speed(bench_.stage, stage().info()));
  time_left_ = TimeLeft(step_times_s_);
  return end(scan(steps));
}

Status Scanner::scan(const ScanPlan& steps) {
  if (steps.steps.empty()) return {};
  if (bench_.stage.home)
    // The operator's word after a trouble homes it, too.
    if (Status status = persist([this] { return state_ == ScanState::homing ? Status{} : home(); }); !status)
      return status;
  first_step_s_ = clock_.now_s();
  go_back_ = false;
  for (std::size_t next = 0;;) {
    if (go_back_) next = go_back(steps.steps, next);
    if (Status status = between_steps(); !status) return status;
    if (!go_back_ && home_check_due(steps.steps, next)) {
      if (Status status = persist([this] { return check_home(); }); !status) return status;
      if (!go_back_) {
        checked_ = next;
        unchecked_.clear();
      }
    }
    if (go_back_) continue;
    if (next == steps.steps.size()) return park();
    const auto taken = [&] { return std::visit([this](const auto& s) { return take(s); }, steps.steps[next]); };
    if (Status status = persist(taken); !status) return status;
    if (go_back_) continue;
    time_left_.step_done(clock_.now_s() - first_step_s_);
    // A slide that was changed is not gone back behind.
    if (std::holds_alternative<SlideStep>(steps.steps[next++])) checked_ = next;
  }
}

/// What the operator asks for.
Status Scanner::between_steps() {
  if (!control_) return {};
  if (control_->paused())
    if (Status status = pause(); !status) return status;
  // Until the first reading of the reference cell there is no dark set to subtract and no drift to record.
  while (reference_read_ && !dark_due_ && !go_back_) {
    const std::optional<CellIndex> cell = control_->next_retake();
    if (!cell) break;
    if (Status status = retake(*cell); !status) return status;
    if (control_->paused())
      if (Status status = pause(); !status) return status;
  }
  return {};
}

Status Scanner::pause() {
  if (Status word = await_operator(); !word) return word;
  return persist([] { return Status{}; });
}

Status Scanner::retake(CellIndex cell) {
  if (!sampling_of(bench_, plan_).contains(cell) || !may_take_again(cell)) return {};
  const CellStep step = make_cell_step(bench_, plan_, cell, stands_mm_, slide_.value_or(0));
  time_left_.insert_step(scan_time_s({step}, bench_, plan_, stage_speed(bench_.stage, stage().info())) -
                         plan_.warm_up_s);
  const int cells_done = progress_.cells_done;
  if (Status status = persist([&] { return take(step); }); !status) return status;
  progress_.cells_done = cells_done;
  if (go_back_) control_->retake({&cell, 1});
  time_left_.step_done(clock_.now_s() - first_step_s_);
  return {};
}

void Scanner::work_on(std::string place, std::optional<CellIndex> cell) {
  progress_.place = std::move(place);
  progress_.cell = cell;
}

Status Scanner::take(const DarkStep& step) {
  work_on("dark set " + std::to_string(step.block + 1));
  Result<Standing> dark = bracket_at(step.stage_mm, progress_.place, Exposures::ladder);
  if (!dark) return tl::unexpected(std::move(dark).error());
  enter(ScanState::delivering);
  dark_ = std::make_shared<const DarkSet>(DarkSet{std::move(dark->bracket), step.block});
  dark_due_ = false;
  return {};
}

Status Scanner::take(const ReferenceStep& step) {
  const std::string place = "reference cell " + to_string(plan_.reference.cell);
  work_on(place);
  if (Status steady = stabilise(step, place); !steady) return steady;
  Result<Standing> lit = bracket_at(step.stage_mm, place, Exposures::plan);
  if (!lit) return tl::unexpected(std::move(lit).error());
  // All drift refers to the first reading.
  if (!reference_read_)
    if (Status held = check_home(); !held) return held;
  const bool first = drift().first_dn_per_s() == 0;
  Result<ReferenceReading> reading = read_light(drift(), lit->bracket, step, place);
  if (!reading) return tl::unexpected(std::move(reading).error());
  if (!reference_read_)
    if (Status changed = check_slide(reading->signal_dn_per_s, first, place); !changed) return changed;
  reading->stabilised = std::exchange(stabilised_, std::nullopt);
  reading->pass = slide_.value_or(0);
  reference_read_ = true;
  reference_due_ = false;
  enter(ScanState::delivering);
  sink_->reference(*reading);
  return check_drift(*reading, place);
}

/// The reference cell's, against the dark set of now.
Result<ReferenceReading> Scanner::read_light(ReferenceDrift& drift, const Bracket& lit, const ReferenceStep& step,
                                             const std::string& place) {
  const std::span<const RawImage> dark = std::span(dark_->bracket).subspan(ladder_.plan_begin, lit.size());
  Result<ReferenceReading> reading = drift.read(lit, dark, bench_.sensor.saturation_dn, step.cells_done);
  if (!reading) return blame(Culprit::lamp, place, std::move(reading).error());
  return reading;
}

Status Scanner::take(const CellStep& step) {
  work_on("cell " + to_string(step.cell), step.cell);
  RawCell raw;
  raw.cell = step.cell;
  raw.passes.resize(step.pass_order.size());
  for (std::size_t k = 0; k < step.pass_order.size(); ++k) {
    const auto index = static_cast<std::size_t>(step.pass_order[k]);
    const std::string& name = bench_.filter.passes[index].name;
    Result<Standing> pass =
        bracket_at(step.stage_mm[k], "cell " + to_string(step.cell) + ", pass " + name, Exposures::adapted);
    if (!pass) return tl::unexpected(std::move(pass).error());
    raw.position_error_mm = std::max(raw.position_error_mm, pass->position_error_mm);
    raw.passes[slide_ ? 0 : index] = RawPass{name, std::move(pass->bracket), pass->stage_mm};
  }
  raw.dark = dark_;
  raw.drift = drift().drift();
  raw.reference_dn_per_s = drift().first_dn_per_s();

  enter(ScanState::delivering);
  Stretch waiting(clock_, timing_.waiting_s);
  sink_->cell(std::move(raw));
  ++progress_.cells_done;
  if (bench_.stage.check_home) unchecked_.push_back(step.cell);
  return {};
}

Status Scanner::take(const VisitStep& step) {
  work_on(step.place);
  const Result<Vec2> stands = stand_at(step.stage_mm, step.place);
  return stands ? Status{} : tl::unexpected(stands.error());
}

Result<Scanner::Standing> Scanner::bracket_at(const Vec2& target_mm, const std::string& place, Exposures exposures) {
  double moved_mm = 0;
  for (int attempt = 0; attempt < attempts; ++attempt) {
    const Result<Vec2> before = stand_at(target_mm, place);
    if (!before) return tl::unexpected(before.error());
    Result<Bracket> bracket = expose_bracket(*before, place, exposures);
    if (!bracket) return tl::unexpected(std::move(bracket).error());
    const Result<Vec2> after = stage().position();
    if (!after) return blame(Culprit::stage, place, after.error());
    moved_mm = (*after - *before).norm();
    if (moved_mm > bench_.tolerance_mm) continue;
    sink_->seen(*bracket, place, *before);
    return Standing{std::move(*bracket), *before, (*before - target_mm).norm()};
  }
  return blame(Culprit::stage, place,
               {"the stage moved by " + say(moved_mm) + " mm during the exposures, twice; " + say(bench_.tolerance_mm) +
                    " mm are allowed",
                {},
                "check that its motors hold and that nothing pulls at it, then resume"});
}

/// Through all of `stops`; nothing tells yet that it came to the last.
Status Scanner::move(std::span<const Vec2> stops, const std::string& place) {
  enter(ScanState::moving);
  if (end_.stop_requested()) return scan_stopped();
  came_to_mm_.reset();
  Stretch moving(clock_, timing_.move_s);
  for (const Vec2& stop : stops)
    if (Status moved = stage().move_to(stop, end_.get_token()); !moved)
      return blame(Culprit::stage, place, std::move(moved).error());
  return {};
}

Result<Vec2> Scanner::stand_at(const Vec2& target_mm, const std::string& place) {
  Vec2 reading(0, 0);
  for (int attempt = 0; attempt < attempts; ++attempt) {
    // Move and let the vibration die away.
    const auto way = way_to(target_mm, bench_.stage.approach_mm, came_to_mm_);
    if (Status moved = move(way, place); !moved) return tl::unexpected(std::move(moved).error());
    came_to_mm_ = target_mm;
    enter(ScanState::settling);
    if (Status status = wait(plan_.settle_s + std::exchange(warm_up_left_s_, 0.0)); !status)
      return tl::unexpected(std::move(status).error());

    // Trust only the position read back.
    const Result<Vec2> position = stage().position();
    if (!position) return blame(Culprit::stage, place, position.error());
    stands_mm_ = reading = *position;
    if ((reading - target_mm).norm() <= bench_.tolerance_mm) return reading;
  }
  return blame(Culprit::stage, place,
               {"the stage stands at " + say(reading) + " mm instead of " + say(target_mm) + " mm, " +
                    say((reading - target_mm).norm()) + " mm off after two moves; " + say(bench_.tolerance_mm) +
                    " mm are allowed",
                {},
                "check for a blocked axis, lost steps or a tolerance below the stage's resolution, then resume"});
}

Status Scanner::park() {
  enter(ScanState::parking);
  Stretch moving(clock_, timing_.move_s);
  if (Status status = stage().move_to(dark_target_mm(bench_), stop_); !status)
    return fail_in("parking", std::move(status).error());
  return {};
}

Status Scanner::end(Status status) {
  if (!status) stage().halt();
  if (!status) tell_unchecked();
  const bool waits_for_slide =
      !status && status.error().kind == ErrorKind::waiting && !progress_.slide.empty() && !stop_.stop_requested();
  if (!status && status.error().kind == ErrorKind::stopped && stop_.stop_requested()) {
    status = scan_stopped();
    enter(ScanState::stopped);
  } else if (!status) {
    if (status.error().kind == ErrorKind::stopped)
      status.error() = {"ended, as nobody takes its cells any more", "scan", {}, ErrorKind::stopped};
    // Bring the lamp behind the opaque patch, unless the stage does not know its place, cannot park or is silent. After
    // a stop it stays where it is.
    if (stop_.stop_requested())
      status.error().remedy += " (the stage is not parked: the operator stopped the scan)";
    else if (state_ != ScanState::homing && state_ != ScanState::parking && stage().position())
      if (const Status parked = park(); !parked) add_not_parked(status.error(), parked.error());
    enter(waits_for_slide ? ScanState::stopped : ScanState::failed);
  } else {
    enter(ScanState::done);
  }
  timing_.total_s = clock_.now_s() - begin_s_;
  timing_.other_s = timing_.total_s - timing_.move_s - timing_.settle_s - timing_.exposure_s - timing_.readout_s -
                    timing_.waiting_s - timing_.paused_s - timing_.lost_s;
  return status;
}

void Scanner::enter(ScanState state) {
  assert(can_follow(state_, state));
  state_ = state;
  const double now_s = clock_.now_s();
  progress_.state = state;
  progress_.elapsed_s = now_s - begin_s_;
  progress_.left_s = is_final(state) ? 0 : time_left_.left_s(now_s - first_step_s_);
  sink_->progress(progress_);
}

Status Scanner::wait(double seconds) {
  Stretch settling(clock_, timing_.settle_s);
  if (!clock_.wait(seconds, end_.get_token())) return scan_stopped();
  return {};
}

}  // namespace lumifield
