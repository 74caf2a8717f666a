#include "renderer/study/run_study.h"

#include <iterator>
#include <optional>

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

/// The parts of a study, one after the other. What fails is left out and told; a stop ends them.
class StudyRun {
 public:
  StudyRun(const StudyJob& job, StudyCamera& camera, const StudyProgress& progress, Study& study)
      : job_(job), camera_(camera), progress_(progress), study_(study) {}

  Status luminaire(std::size_t k) {
    const StudyLuminaire& luminaire = job_.luminaires[k];
    const std::size_t before = study_.points.size();
    if (Status done = or_omitted(luminaire.name, ladders(k)); !done) return done;
    if (study_.points.size() == before) return {};  // what has no ladder has nothing else
    const std::vector<StudyLook> all = looks(k == 0, job_.quick);
    for (std::size_t l = 0; l < all.size(); ++l) {
      const double each = 0.2 / static_cast<double>(all.size()), from = 0.7 + each * static_cast<double>(l);
      const std::string part = luminaire.name + ", " + all[l].name();
      if (Status done = or_omitted(part, look(luminaire, all[l], this->part(k, from, from + each))); !done) return done;
    }
    return job_.ladders_only ? Status{} : figures_of(k);
  }

  Status spotlights() {
    if (job_.ladders_only) return {};
    take(constant_distance_figures());
    return figures("Table 1", spot_speed_figures(job_.quick, after_ladders(0, 0.2)));
  }

  Status lit_by(const LatLong& environment) {
    return figures("Fig. 20-8", environment_figures(environment, after_ladders(0.2, 0.4)));
  }

  Status stability() {
    study_.stability = without_;
    if (job_.ladders_only) return {};
    auto table = stability_table(after_ladders(job_.scene.environment ? 0.4 : 0.2, 1));
    if (!table) return or_omitted("stability", tl::unexpected(table.error()));
    study_.stability.insert(study_.stability.begin(), table->begin(), table->end());
    return {};
  }

  /// What the first part that was left out fell to.
  const std::optional<Error>& first_fault() const { return first_fault_; }

 private:
  /// The ladders take most of the time, spotlights, environment and table the rest.
  static constexpr double ladders_share = 0.85;

  StudyProgress part(std::size_t k, double from, double to) const {
    const double each = ladders_share / static_cast<double>(job_.luminaires.size());
    return [=, this](double share, const std::string& what) {
      return progress_(each * (static_cast<double>(k) + from + (to - from) * share), what);
    };
  }
  StudyProgress after_ladders(double from, double to) const {
    return [=, this](double share, const std::string& what) {
      return progress_(ladders_share + (1 - ladders_share) * (from + (to - from) * share), what);
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
  /// Hours may be in the study by now: none are lost to a part.
  Status or_omitted(const std::string& part, Status done) {
    if (done || done.error().kind == ErrorKind::stopped) return done;
    if (!first_fault_) first_fault_ = done.error();
    study_.omissions.push_back({part, done.error().message()});
    return {};
  }
  Status figures(const std::string& part, Result<std::vector<FigureRow>> rows) {
    if (!rows) return or_omitted(part, tl::unexpected(rows.error()));
    take(std::move(*rows));
    return {};
  }
  /// Of all methods, with plain surfaces, and what the paper has of them.
  Status ladders(std::size_t k) {
    const StudyLuminaire& luminaire = job_.luminaires[k];
    const auto bench = StudyBench::create(camera_, luminaire, job_.cache);
    if (!bench) return tl::unexpected(bench.error());
    auto climb = climb_ladder(**bench, job_.quick, part(k, 0, 0.5));
    if (!climb) return tl::unexpected(climb.error());
    take(equal_error_rows(climb->points, luminaire.name));
    Status done;
    if (!job_.ladders_only)
      done = figures(luminaire.name + ", the paper's figures", paper_figures(**bench, job_.quick, part(k, 0.5, 0.5)));
    if (done && k == 0)
      done = or_omitted(luminaire.name + " at 1024x768",
                        confirm_at_full_size(**bench, camera_, job_.quick, part(k, 0.6, 0.7), *climb));
    take(*climb);
    return done;
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
  /// Shadows, mixtures and a whole frame, of those luminaires that have them.
  Status figures_of(std::size_t k) {
    const StudyLuminaire& luminaire = job_.luminaires[k];
    if (k == 0 || !job_.quick) {
      Status done = figures(luminaire.name + ", shadows", shadow_figures(camera_, luminaire, part(k, 0.9, 0.92)));
      if (done)
        done = figures(luminaire.name + ", mis",
                       mis_figures(camera_, luminaire, job_.cache, job_.quick, part(k, 0.92, 0.95)));
      if (!done) return done;
    }
    if (k + 1 < job_.luminaires.size()) return {};
    return figures(luminaire.name + ", a whole frame", frame_figures(camera_, luminaire, job_.quick, part(k, 0.95, 1)));
  }

  const StudyJob& job_;
  StudyCamera& camera_;
  const StudyProgress& progress_;
  Study& study_;
  std::vector<StabilityRow> without_;
  std::optional<Error> first_fault_;
};

/// Of the scene, where the study needs it.
Result<std::optional<LatLong>> read_environment(const StudyJob& job) {
  if (job.ladders_only || !job.scene.environment) return std::nullopt;
  auto environment = LatLong::read(*job.scene.environment);
  if (!environment) return tl::unexpected(environment.error());
  return std::move(*environment);
}

}  // namespace

Result<Study> run_study(const StudyJob& job, const StudyProgress& progress) {
  Study study;
  study.scene = job.scene.name;
  study.quick = job.quick;
  const auto environment = read_environment(job);
  if (!environment) return tl::unexpected(environment.error());
  const auto camera = StudyCamera::create(job.scene);
  if (!camera) return tl::unexpected(camera.error());
  StudyRun run(job, **camera, progress, study);
  for (std::size_t k = 0; k < job.luminaires.size(); ++k)
    if (const Status done = run.luminaire(k); !done) return tl::unexpected(done.error());
  if (study.points.empty() && run.first_fault()) return tl::unexpected(*run.first_fault());
  if (const Status done = run.spotlights(); !done) return tl::unexpected(done.error());
  if (*environment)
    if (const Status done = run.lit_by(**environment); !done) return tl::unexpected(done.error());
  if (const Status done = run.stability(); !done) return tl::unexpected(done.error());
  progress(1, "done");
  return study;
}

}  // namespace lumifield
