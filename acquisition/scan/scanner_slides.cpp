// What the scanner does where the operator changes the pass: scanner.h, "Slides".
#include <cmath>
#include <utility>

#include "acquisition/scan/scanner.h"

namespace lumifield {

namespace {

const std::string& name_of(const Bench& bench, int pass) {
  return bench.filter.passes[static_cast<std::size_t>(pass)].name;
}

std::string quoted(const Bench& bench, int pass) { return "'" + name_of(bench, pass) + "'"; }

}  // namespace

Status Scanner::take(const SlideStep& step) {
  if (slide_ && *slide_ != step.pass) return wait_for_slide(step);
  if (!slide_) {
    slide_ = step.pass;
    sink_->notice("the slide " + quoted(bench_, step.pass) + " is taken to be in");
  }
  progress_.pass = name_of(bench_, step.pass);
  progress_.cells_done = progress_.cells_before = step.cells_before;
  return {};
}

/// Out of the operator's way.
Status Scanner::wait_for_slide(const SlideStep& step) {
  work_on("slide " + quoted(bench_, step.pass));
  if (Status moved = move(std::span(&step.stage_mm, 1), progress_.place); !moved) return moved;
  slide_doubted_ = false;
  return ask_for_slide(step.pass, "the pass " + quoted(bench_, *slide_) + " is taken", "slide");
}

/// A trouble that the operator helps with: then the step is taken again.
tl::unexpected<Error> Scanner::ask_for_slide(int pass, std::string why, const std::string& place) {
  slide_asked_ = pass;
  progress_.slide = name_of(bench_, pass);
  const bool attended = control_ && control_->attended();
  std::string remedy = "put in the slide " + quoted(bench_, pass);
  if (attended) remedy += ", then go on";
  if (!attended && slide_doubted_) remedy += ", or say by --accept-drift that it is in";
  return blame(Culprit::slide, place, {std::move(why), {}, std::move(remedy), ErrorKind::waiting});
}

/// It is in now: nothing that was seen through the one before is of use.
Status Scanner::change_slide() {
  slide_ = slide_asked_;
  progress_.slide.clear();
  reference_read_ = reference_due_ = false;
  stabilisation_due_ = true;  // the lamp may have been off
  drift_seen_ = 0;
  return bench_.stage.home ? home() : Status{};
}

/// The likeliest mistake is that the slide was not changed: then all reads as before. `is_first`: no earlier scan has a
/// reading through this one.
Status Scanner::check_slide(double signal_dn_per_s, bool is_first, const std::string& place) {
  if (!slide_ || slide_doubted_ || !drift_seen_) return {};
  const auto reads_as = [&](double dn_per_s) {
    return std::abs(signal_dn_per_s / dn_per_s - 1) <= plan_.reference.limit;
  };
  if (!is_first && reads_as(drift().first_dn_per_s())) return {};
  for (const auto& [pass, other] : drifts_) {
    const double first = other.first_dn_per_s(), last = first * (1 + other.drift());
    if (pass == *slide_ || !(reads_as(first) || reads_as(last))) continue;
    if (is_first) drifts_[*slide_] = ReferenceDrift();
    slide_doubted_ = true;
    return ask_for_slide(*slide_, "it reads as through " + quoted(bench_, pass), place);
  }
  return {};
}

/// Of the other passes there is nothing to make a cell whole with that this scan does not take.
bool Scanner::may_take_again(CellIndex cell) const {
  if (!slide_) return true;
  for (const ScanStep& step : steps_->steps)
    if (const auto* taken = std::get_if<CellStep>(&step); taken && taken->cell == cell) return true;
  sink_->notice("cell " + to_string(cell) + " is not taken again: it was whole before this scan, and the slide " +
                quoted(bench_, *slide_) +
                " alone is not enough; select it once more when the scan has ended, which asks for every slide");
  return false;
}

}  // namespace lumifield
