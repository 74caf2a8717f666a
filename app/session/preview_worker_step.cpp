#include <algorithm>
#include <utility>

#include "app/session/preview_worker.h"
#include "renderer/false_colour.h"

namespace lumifield {

namespace {

using Clock = PreviewWorker::Clock;

/// A full picture that takes no longer needs no coarse one before it.
constexpr double short_wait_s = 0.15;
/// Cells that come in one go and send a full picture back to a coarse one.
constexpr int many_cells = 8;
/// While many cells come, a picture that grows is shown this often.
constexpr double refresh_s = 0.1;
/// A hasty picture that takes as long as it is meant to is one piece.
constexpr double hasty_slices = 2;
/// Progress is told this often.
constexpr double tell_s = 0.2;
/// The scan gets the cores back after so much work without a frame.
constexpr double longest_work_s = 0.25, longest_rest_s = 0.25;

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

/// A size that is none stays none, to be refused.
int divided(int size_px, int divisor) { return std::max(std::min(size_px, 1), (size_px + divisor / 2) / divisor); }

}  // namespace

PreviewWorker::Next PreviewWorker::step() {
  const Clock::time_point start = Clock::now();
  framed_ = false;
  const Next next = rested(work(), start);
  if (framed_ || next.wake == Clock::time_point::max() || Clock::now() - told_at_ > seconds(tell_s)) tell_progress();
  return next;
}

/// While a scan runs: after a frame, or work without one, the thread rests as long as it worked.
PreviewWorker::Next PreviewWorker::rested(Next next, Clock::time_point start) {
  worked_s_ += seconds_since(start);
  if (framed_ || worked_s_ > longest_work_s) {
    if (scan_) next.rest = std::max(next.rest, Clock::now() + seconds(std::min(worked_s_, longest_rest_s)));
    worked_s_ = 0;
  }
  return next;
}

PreviewWorker::Next PreviewWorker::work() {
  const Clock::time_point now = Clock::now();
  if (look_changed_ && last_) {
    if (now < due()) return {{}, due()};
    show_again();
    return {{}, Clock::now()};
  }
  if (!renderer_ || !lit_ || stuck_) return {};

  // Draw, hand over, sum or show: what comes next. A hasty picture is made to its end, whatever view or cell comes in
  // between: newer ones may come faster than any is made.
  const bool under_way = drawn_ && hasty_ && dirty_;
  const PreviewDetail detail = under_way ? *drawn_ : detail_wanted(now);
  if (!under_way && (view_changed_ || drawn_ != detail)) {
    // A picture that would be ready too soon is begun later, with the camera of then.
    const Clock::time_point begin = due() - seconds(coarse_took_s_);
    if (moving_ && now < begin) return {begin, begin};
    draw(detail);
    return {{}, Clock::now()};
  }
  if (!handed_over_) {
    hand_over();
    return {{}, Clock::now()};
  }
  if (!surround()) return {{}, Clock::now()};
  const bool waits = renderer_->waiting() > 0;
  const bool refresh = waits && dirty_ && !hasty_ && caught_up_ && !together() && sum_s_ > 0 &&
                       now >= last_frame_at_ + seconds(refresh_s);
  if (waits && !refresh) {
    sum();
    return {{}, Clock::now()};
  }
  if (dirty_) {
    if (now < due()) return {due(), due()};
    show();
    return {{}, Clock::now()};
  }
  if (!moving_ && !detail.full()) return {{}, last_cell_at_ + seconds(pace_.moment)};
  return {};
}

PreviewDetail PreviewWorker::detail_wanted(Clock::time_point now) const {
  const int cells = static_cast<int>(cells_.size());
  const double full_s = costs_.picture_s({}, view_.receivers(), cells);
  if (!view_changed_ && drawn_) return moving_ && !drawn_->full() ? *drawn_ : resting_detail(now);
  if (together() && !costs_.known() && cells > 0) return coarsest();
  if (!moving_ && full_s <= short_wait_s) return {};
  return costs_.finest_within(scan_ ? pace_.coarse / 2 : pace_.coarse, view_.receivers(), cells,
                              drawn_.value_or(PreviewDetail{}));
}

/// Of a view that is drawn.
PreviewDetail PreviewWorker::resting_detail(Clock::time_point now) const {
  const int waiting = renderer_->waiting();
  const PreviewDetail coarse = costs_.finest_within(scan_ ? pace_.coarse / 2 : pace_.coarse, view_.receivers(),
                                                    static_cast<int>(cells_.size()), *drawn_);
  if (drawn_->full()) {
    const int cells = static_cast<int>(cells_.size());
    const double cell_s = costs_.cell_s({}, view_.receivers());
    if (!caught_up()) return burst_ >= many_cells ? coarse : *drawn_;
    if (!together()) return shows_coarsely_first(waiting, cells, cell_s) ? coarse : *drawn_;
    if (waiting == 0 || sum_s_ > 0) return *drawn_;  // none is under way, or one that is made to its end
    if (!costs_.known()) return coarsest();
    return shows_all_coarsely_first(static_cast<int>(fresh_.size()), cells, cell_s) ? coarse : *drawn_;
  }
  if (waiting > 0 || dirty_) return *drawn_;
  return all_in() || now >= last_cell_at_ + seconds(pace_.moment) ? PreviewDetail{} : *drawn_;
}

void PreviewWorker::draw(PreviewDetail detail) {
  const Clock::time_point start = Clock::now();
  drawn_.reset();
  let_in();
  // Luminaires that are refused leave those of the picture before.
  if (const Status placed = renderer_->set_placements(view_.placements); !placed) {
    report(placed.error());
    view_.placements = placed_;
    if (const Status again = renderer_->set_placements(placed_); !again) return stop_at(again.error());
  }
  placed_ = view_.placements;
  const int width = divided(view_.width_px, detail.divisor), height = divided(view_.height_px, detail.divisor);
  if (const Status viewed = renderer_->set_view(view_.camera, width, height, detail.lod); !viewed)
    return stop_at(viewed.error());
  drawn_ = detail;
  drawn_view_ = view_;
  hasty_ = moving_ || !detail.full();
  view_changed_ = false;
  caught_up_ = renderer_->waiting() == 0;
  dirty_ = true;
  burst_ = 0;
  handed_over_ = false;
  unlearned_s_ = surround_s_ = 0;
  draw_s_ = seconds_since(start);
  if (hasty_) hand_over();
}

/// Of the picture that is drawn, by the size asked for: what costs are learned for.
double PreviewWorker::drawn_receivers() const { return drawn_view_.receivers() / (drawn_->divisor * drawn_->divisor); }

void PreviewWorker::hand_over() {
  const Clock::time_point start = Clock::now();
  if (const Status handed = renderer_->hand_over(); !handed) return stop_at(handed.error());
  handed_over_ = true;
  sum_began_at_ = Clock::now();
  draw_s_ += seconds_since(start);
  if (!drawn_->full()) coarse_took_s_ = draw_s_;
  costs_.drawn(*drawn_, drawn_receivers(), draw_s_);
}

/// True when the view has the environment's light.
bool PreviewWorker::surround() {
  const Clock::time_point start = Clock::now();
  const bool all = renderer_->surround(hasty_ ? hasty_slices * pace_.slice : pace_.slice);
  const double took_s = seconds_since(start);
  surround_s_ += took_s;
  draw_s_ += took_s;
  if (!drawn_->full()) coarse_took_s_ += took_s;
  return all;
}

void PreviewWorker::sum() {
  const Clock::time_point start = Clock::now();
  const int before = renderer_->waiting();
  if (const Status done = renderer_->sum_some(hasty_ ? hasty_slices * pace_.slice : pace_.slice); !done)
    return stop_at(done.error());
  // Published shadows that move have all cells wait anew: until they are in again the picture has fewer than before.
  caught_up_ = renderer_->waiting() == 0 || (caught_up_ && renderer_->waiting() <= before);
  dirty_ = true;
  const double took_s = seconds_since(start);
  sum_s_ += took_s;
  if (!drawn_->full()) coarse_took_s_ += took_s;
  // Methods that compute all cells together end their waiting with the last piece.
  unlearned_s_ += took_s;
  const int summed = before - renderer_->waiting();
  if (summed > 0) costs_.summed(*drawn_, drawn_receivers(), summed, std::exchange(unlearned_s_, 0));
}

void PreviewWorker::show() {
  const Clock::time_point start = Clock::now();
  Result<Picture> picture = renderer_->picture_so_far();
  if (!picture) return stop_at(picture.error());
  PreviewFrame frame;
  frame.radiance = std::make_shared<const Picture>(std::move(*picture));
  frame.camera = drawn_view_.camera;
  frame.placements = drawn_view_.placements;
  frame.method = method_;
  frame.visibility = visibility_;
  frame.environment = renderer_->environment();
  frame.cells = renderer_->summed();
  frame.total = geometry_->sampling.cells();
  frame.measured = static_cast<int>(cells_.size());
  frame.half = static_cast<int>(half_.size());
  frame.luminaire = luminaire_;
  frame.coarse = !drawn_->full();
  frame.draw_s = std::exchange(draw_s_, 0);
  frame.sum_s = std::exchange(sum_s_, 0);
  Clock::time_point oldest = Clock::time_point::max();
  for (auto cell = fresh_.begin(); cell != fresh_.end();) {
    const bool in = !held_.contains(cell->first) && !renderer_->waits(cell->first);
    if (in) oldest = std::min(oldest, cell->second);
    cell = in ? fresh_.erase(cell) : std::next(cell);
  }
  if (oldest != Clock::time_point::max()) frame.handed_in = oldest;
  dirty_ = false;
  last_error_.clear();
  stopped_.reset();
  const PreviewDetail detail = *drawn_;
  const double receivers = drawn_receivers();
  hand_out(std::move(frame), start);
  costs_.shown(detail, receivers, last_->show_s + std::exchange(surround_s_, 0));
  if (!detail.full()) coarse_took_s_ += last_->show_s;
  // Else coarse pictures would follow each other for as long as cells come faster than they are made.
  const bool full_follows = together() && !detail.full() && !moving_ && burst_ < many_cells;
  if (!holds_cells() && !full_follows) let_in();
}

/// The last picture with another look.
void PreviewWorker::show_again() {
  PreviewFrame frame = *last_;
  frame.draw_s = frame.sum_s = 0;
  frame.handed_in = {};
  hand_out(std::move(frame), Clock::now());
}

void PreviewWorker::hand_out(PreviewFrame frame, Clock::time_point start) {
  frame.look = look_;
  look_changed_ = false;
  const Picture& picture = *frame.radiance;
  frame.average = look_.tone.white > 0 ? look_.tone.white : average_luminance(picture);
  frame.scale_top = look_.false_colour_top;
  if (look_.false_colour && !(frame.scale_top > 0)) frame.scale_top = largest_luminance(picture);
  frame.shown = look_.false_colour ? false_colours(picture, frame.scale_top)
                                   : tone_map(picture, {look_.tone.exposure, frame.average});
  frame.show_s = seconds_since(start);
  last_ = std::make_shared<const PreviewFrame>(std::move(frame));
  last_frame_at_ = Clock::now();
  framed_ = true;
  if (callbacks_.frame) callbacks_.frame(last_);
}

void PreviewWorker::stop_at(const Error& error) {
  drawn_.reset();
  stuck_ = true;
  stopped_ = error;
  report(error);
}

}  // namespace lumifield
