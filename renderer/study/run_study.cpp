#include "renderer/study/run_study.h"

#include <iterator>

#include "renderer/study/environment_figures.h"
#include "renderer/study/frame_figures.h"
#include "renderer/study/ladder.h"
#include "renderer/study/ladder_rows.h"
#include "renderer/study/mis_figures.h"
#include "renderer/study/paper_figures.h"
#include "renderer/study/shadow_figures.h"
#include "renderer/study/spot_error_figures.h"
#include "renderer/study/spot_figures.h"
#include "renderer/study/stability.h"

namespace lumifield {

namespace {

/// The looks, all in shadow, in which the closed form and samples with the same tiles climb their ladders. Gloss is the
/// first luminaire's alone.
std::vector<StudyLook> looks(bool first, bool quick) {
  std::vector<StudyLook> all{{.visibility = Visibility::tile}};
  if (quick && !first) return {};
  if (!first) return all;
  for (const double roughness : quick ? std::vector{0.2} : std::vector{0.5, 0.3, 0.2, 0.1, 0.05})
    all.push_back({.visibility = Visibility::tile, .roughness = roughness});
  return all;
}

/// The parts of a study, one after the other; the first error ends it.
class StudyRun {
 public:
  StudyRun(const StudyJob& job, StudyCamera& camera, const StudyProgress& progress, Study& study)
      : job_(job), camera_(camera), progress_(progress), study_(study) {}

  Status luminaire(std::size_t k) {
    const StudyLuminaire& luminaire = job_.luminaires[k];
    const bool first = k == 0, last = k + 1 == job_.luminaires.size();
    const auto bench = StudyBench::create(camera_, luminaire, job_.cache);
    if (!bench) return tl::unexpected(bench.error());
    auto climb = climb_ladder(**bench, job_.quick, part(k, 0, 0.5));
    if (!climb) return tl::unexpected(climb.error());
    take(equal_error_rows(climb->points, luminaire.name));
    if (!job_.ladders_only)
      if (Status done = figures(paper_figures(**bench, job_.quick, part(k, 0.5, 0.5))); !done) return done;
    if (first)
      if (Status full = confirm_at_full_size(**bench, camera_, job_.quick, part(k, 0.6, 0.7), *climb); !full)
        return full;
    take(*climb);
    const std::vector<StudyLook> all = looks(first, job_.quick);
    for (std::size_t l = 0; l < all.size(); ++l) {
      const double each = 0.2 / static_cast<double>(all.size()), from = 0.7 + each * static_cast<double>(l);
      if (Status done = look(luminaire, all[l], part(k, from, from + each)); !done) return done;
    }
    if (job_.ladders_only) return {};
    if (first || !job_.quick)
      if (Status done = shadows_and_mixtures(k); !done) return done;
    return last ? figures(frame_figures(camera_, luminaire, job_.quick, part(k, 0.95, 1))) : Status{};
  }

  Status spotlights() {
    if (job_.ladders_only) return {};
    take(constant_distance_figures());
    return figures(spot_speed_figures(job_.quick, after_ladders(0, 0.2)));
  }

  Status environment() {
    if (job_.ladders_only || !job_.scene.environment) return {};
    const auto environment = LatLong::read(*job_.scene.environment);
    if (!environment) return tl::unexpected(environment.error());
    return figures(environment_figures(*environment, after_ladders(0.2, 0.4)));
  }

  Status stability() {
    study_.stability = without_;
    if (job_.ladders_only) return {};
    auto table = stability_table(after_ladders(job_.scene.environment ? 0.4 : 0.2, 1));
    if (!table) return tl::unexpected(table.error());
    study_.stability.insert(study_.stability.begin(), table->begin(), table->end());
    return {};
  }

 private:
  /// The ladders take most of the time, spotlights, environment and table the rest.
  static constexpr double ladders = 0.85;

  StudyProgress part(std::size_t k, double from, double to) const {
    const double each = ladders / static_cast<double>(job_.luminaires.size());
    return [=, this](double share, const std::string& what) {
      return progress_(each * (static_cast<double>(k) + from + (to - from) * share), what);
    };
  }
  StudyProgress after_ladders(double from, double to) const {
    return [=, this](double share, const std::string& what) {
      return progress_(ladders + (1 - ladders) * (from + (to - from) * share), what);
    };
  }
  void take(std::vector<FigureRow> rows) {
    study_.figures.insert(study_.figures.end(), std::make_move_iterator(rows.begin()),
                          std::make_move_iterator(rows.end()));
  }
  void take(const Climb& climb) {
    study_.points.insert(study_.points.end(), climb.points.begin(), climb.points.end());
    without_.insert(without_.end(), climb.without.begin(), climb.without.end());
  }
  Status shadows_and_mixtures(std::size_t k) {
    const StudyLuminaire& luminaire = job_.luminaires[k];
    if (Status done = figures(shadow_figures(camera_, luminaire, part(k, 0.9, 0.92))); !done) return done;
    return figures(mis_figures(camera_, luminaire, job_.cache, job_.quick, part(k, 0.92, 0.95)));
  }
  Status figures(Result<std::vector<FigureRow>> rows) {
    if (!rows) return tl::unexpected(rows.error());
    take(std::move(*rows));
    return {};
  }
  /// The luminaire's ladders with other surfaces.
  Status look(const StudyLuminaire& luminaire, const StudyLook& look, const StudyProgress& progress) {
    const auto bench = StudyBench::create(camera_, luminaire, job_.cache, look);
    if (!bench) return tl::unexpected(bench.error());
    const auto climb = climb_ladder(**bench, job_.quick, progress);
    if (!climb) return tl::unexpected(climb.error());
    take(equal_time_rows(climb->points, (*bench)->name()));
    take(*climb);
    return {};
  }

  const StudyJob& job_;
  StudyCamera& camera_;
  const StudyProgress& progress_;
  Study& study_;
  std::vector<StabilityRow> without_;
};

}  // namespace

Result<Study> run_study(const StudyJob& job, const StudyProgress& progress) {
  Study study{job.scene.name, job.quick, {}, {}, {}};
  const auto camera = StudyCamera::create(job.scene);
  if (!camera) return tl::unexpected(camera.error());
  StudyRun run(job, **camera, progress, study);
  for (std::size_t k = 0; k < job.luminaires.size(); ++k)
    if (const Status done = run.luminaire(k); !done) return tl::unexpected(done.error());
  if (const Status done = run.spotlights(); !done) return tl::unexpected(done.error());
  if (const Status done = run.environment(); !done) return tl::unexpected(done.error());
  if (const Status done = run.stability(); !done) return tl::unexpected(done.error());
  progress(1, "done");
  return study;
}

}  // namespace lumifield
