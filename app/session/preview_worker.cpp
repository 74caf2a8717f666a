#include "app/session/preview_worker.h"

#include <algorithm>
#include <tuple>
#include <utility>

namespace lumifield {

namespace {

/// Of a picture's light, from which the time for the rest is told.
constexpr double least_share = 0.02;

}  // namespace

PreviewWorker::PreviewWorker(LivePreview::Callbacks callbacks, PreviewPace pace, std::stop_token stop)
    : callbacks_(std::move(callbacks)), pace_(pace), stop_(std::move(stop)) {}

bool PreviewWorker::same(const View& a, const View& b) {
  const auto alike = [](const ScenePlacement& p, const ScenePlacement& q) {
    return p.pose == q.pose && p.scale == q.scale;
  };
  return std::ranges::equal(a.placements, b.placements, alike) && a.width_px == b.width_px &&
         a.height_px == b.height_px && a.camera.position_mm == b.camera.position_mm &&
         a.camera.target_mm == b.camera.target_mm && a.camera.up == b.camera.up &&
         a.camera.fov_y_deg == b.camera.fov_y_deg;
}

void PreviewWorker::take(PreviewCommands commands) {
  // A look alone does not ask for another try.
  if (commands.scene || commands.luminaire || !commands.cells.empty() || commands.camera || commands.placements ||
      commands.size_px || commands.method || commands.visibility || commands.refresh_shadows)
    stuck_ = false;
  if (commands.scene) take_scene(*commands.scene);
  if (commands.method) take_method(*commands.method);
  if (commands.visibility) take_visibility(*commands.visibility);
  if (commands.environment) take_environment(*commands.environment);
  if (commands.refresh_shadows && renderer_) {
    renderer_->refresh_shadows();
    view_changed_ = true;
  }
  if (commands.luminaire) take_luminaire(*commands.luminaire);
  // Before the cells, which wait for a view that is to come.
  const View before = view_;
  if (commands.camera) view_.camera = *commands.camera;
  if (commands.placements) view_.placements = std::move(*commands.placements);
  if (commands.size_px) std::tie(view_.width_px, view_.height_px) = *commands.size_px;
  if (!same(before, view_)) view_changed_ = true;
  for (PreviewCommands::Cell& cell : commands.cells) take_cell(std::move(cell));
  for (const CellIndex cell : commands.refused)
    report({"there is no luminaire yet", "cell " + to_string(cell), "set the luminaire first"});
  if (commands.moving) moving_ = *commands.moving;
  if (commands.scan_running) scan_ = *commands.scan_running;
  if (commands.look) {
    look_ = *commands.look;
    look_changed_ = true;
  }
  tell_progress();
}

void PreviewWorker::take_scene(const Scene& scene) {
  // The old one goes first, so that two never need memory at once.
  renderer_.reset();
  lit_ = false;
  drawn_.reset();
  moving_ = false;
  view_.camera = scene.camera;
  view_.placements = placed_ = scene.luminaires;
  view_changed_ = true;
  last_.reset();
  last_error_.clear();
  stopped_.reset();
  // Any size does: the view is drawn when it is needed.
  Result<std::unique_ptr<Renderer>> renderer = Renderer::create(scene, 64, 48, stop_);
  if (!renderer && renderer.error().kind == ErrorKind::stopped) return;  // nobody looks any more
  if (!renderer) return report(renderer.error());
  renderer_ = std::move(*renderer);
  if (const Status set = renderer_->set_method(method_); !set) {
    method_ = {};
    refused_ = set.error();
    report(set.error());
  }
  if (const Status set = renderer_->set_visibility(visibility_); !set) report(set.error());
  take_environment(environment_);
  if (callbacks_.ready) callbacks_.ready(renderer_->info());
  if (geometry_) light();
}

void PreviewWorker::take_luminaire(const PreviewCommands::Luminaire& luminaire) {
  geometry_ = luminaire.geometry;
  luminaire_ = luminaire.number;
  cells_.clear();
  half_.clear();
  fresh_.clear();
  last_.reset();
  last_error_.clear();
  stopped_.reset();
  if (renderer_) light();
}

/// What another method costs is learned anew.
void PreviewWorker::take_method(const MethodSettings& method) {
  asked_ = method;
  refused_.reset();
  if (renderer_)
    if (const Status set = renderer_->set_method(method); !set) {
      refused_ = set.error();
      return report(set.error());
    }
  method_ = method;
  begin_anew();
  // A luminaire that could not be taken before.
  if (renderer_ && geometry_ && !lit_) light();
}

/// As of another method.
void PreviewWorker::take_visibility(Visibility visibility) {
  if (renderer_)
    if (const Status set = renderer_->set_visibility(visibility); !set) return report(set.error());
  visibility_ = visibility;
  begin_anew();
}

/// The sums stay: the same picture is shown with or without it.
void PreviewWorker::take_environment(bool on) {
  environment_ = on;
  if (!renderer_ || !renderer_->info().has_environment) return;
  if (const Status set = renderer_->set_environment(on); !set) return report(set.error());
  if (drawn_ && handed_over_) dirty_ = true;
}

/// With the picture, at costs that are not known.
void PreviewWorker::begin_anew() {
  costs_ = {};
  last_error_.clear();
  stopped_.reset();
  drawn_.reset();
  view_changed_ = true;
}

/// Hands the renderer the luminaire and its cells.
void PreviewWorker::light() {
  drawn_.reset();
  held_.clear();
  view_changed_ = true;
  const Status set = renderer_->set_luminaire(*geometry_);
  lit_ = set.has_value();
  if (!set) return report(set.error());
  for (const auto& [cell, image] : cells_)
    if (const Status kept = renderer_->keep_cell(cell, image); !kept) report(kept.error());
}

void PreviewWorker::take_cell(PreviewCommands::Cell cell) {
  if (!cell.image) return report({"comes without an image", "cell " + to_string(cell.cell), "measure the cell again"});
  if (const Status fits = check_cell(*geometry_, cell.cell, *cell.image); !fits) return report(fits.error());
  burst_ = cell.handed_in - last_cell_at_ < seconds(pace_.moment) ? burst_ + 1 : 1;
  last_cell_at_ = std::max(last_cell_at_, cell.handed_in);
  fresh_.try_emplace(cell.cell, cell.handed_in);
  cells_[cell.cell] = std::move(cell.image);
  cell.half ? void(half_.insert(cell.cell)) : void(half_.erase(cell.cell));
  if (!lit_) return;
  held_.insert(cell.cell);
  if (!holds_cells()) let_in();
}

/// A method that computes all cells together begins anew with each: they wait for the end of a picture, and for the
/// view that is to follow a hasty one. Of an additive method each costs a full picture that has not caught up as much
/// as many of its own.
bool PreviewWorker::holds_cells() const {
  if (!drawn_) return false;
  const bool under_way = dirty_ && renderer_->waiting() > 0;
  if (!together()) return !hasty_ && under_way && !caught_up_;
  return under_way || (hasty_ && view_changed_);
}

void PreviewWorker::let_in() {
  if (!held_.empty()) sum_began_at_ = Clock::now();
  for (const CellIndex cell : std::exchange(held_, {})) {
    dirty_ = true;
    if (const Status kept = renderer_->keep_cell(cell, cells_.at(cell)); !kept) report(kept.error());
  }
}

void PreviewWorker::report(const Error& error) {
  if (std::exchange(last_error_, error.message()) == error.message()) return;
  if (callbacks_.failed) callbacks_.failed(error);
}

/// A cell that is added to a full picture takes no time worth a word.
bool PreviewWorker::working() const {
  if (!renderer_ || !lit_ || stuck_) return false;
  if (view_changed_ || !drawn_ || !drawn_->full() || !held_.empty()) return true;
  return renderer_->waiting() > 0 && (together() || !caught_up_);
}

void PreviewWorker::tell_progress() {
  told_at_ = Clock::now();
  if (!callbacks_.progress) return;
  PreviewProgress progress{asked_, visibility_, renderer_ && renderer_->environment(), refused_ ? refused_ : stopped_};
  progress.working = working();
  if (progress.working && drawn_ && !view_changed_) {
    progress.coarse = !drawn_->full();
    progress.share = handed_over_ ? renderer_->share_summed() : 0;
    const double took_s = std::chrono::duration<double>(told_at_ - sum_began_at_).count();
    if (progress.share > least_share) progress.left_s = took_s * (1 - progress.share) / progress.share;
  }
  callbacks_.progress(progress);
}

void PreviewWorker::give_up(const Error& error) {
  renderer_.reset();
  lit_ = false;
  report(error);
}

}  // namespace lumifield
