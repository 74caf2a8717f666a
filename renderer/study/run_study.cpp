#include "renderer/study/run_study.h"

#include "renderer/study/ladder.h"
#include "renderer/study/paper_figures.h"
#include "renderer/study/stability.h"

namespace lumifield {

Result<Study> run_study(const StudyJob& job, const StudyProgress& progress) {
  Study study{job.scene.name, job.quick, {}, {}, {}};
  auto camera = StudyCamera::create(job.scene);
  if (!camera) return tl::unexpected(camera.error());

  std::vector<StabilityRow> without;

  // The ladders take most of the time, the table and the pictures at full size the rest.
  const double ladders = 0.85,
               each_share = ladders / static_cast<double>(std::max<std::size_t>(job.luminaires.size(), 1));
  for (std::size_t k = 0; k < job.luminaires.size(); ++k) {
    const auto part = [&](double from, double to) {
      return [&, from, to](double share, const std::string& what) {
        return progress(each_share * (static_cast<double>(k) + from + (to - from) * share), what);
      };
    };
    auto bench = StudyBench::create(**camera, job.luminaires[k], job.cache);
    if (!bench) return tl::unexpected(bench.error());
    auto climb = climb_ladder(**bench, job.quick, part(0, 0.7));
    if (!climb) return tl::unexpected(climb.error());
    for (FigureRow& row : equal_error_rows(climb->points, job.luminaires[k].name))
      study.figures.push_back(std::move(row));
    auto figures = paper_figures(**bench, job.quick, part(0.7, 0.7));
    if (!figures) return tl::unexpected(figures.error());
    for (FigureRow& row : *figures) study.figures.push_back(std::move(row));
    if (k == 0)
      if (Status full = confirm_at_full_size(**bench, **camera, job.quick, part(0.85, 1), *climb); !full)
        return tl::unexpected(full.error());
    study.points.insert(study.points.end(), climb->points.begin(), climb->points.end());
    without.insert(without.end(), climb->without.begin(), climb->without.end());
  }
  auto table = stability_table(
      [&](double share, const std::string& what) { return progress(ladders + (1 - ladders) * share, what); });
  if (!table) return tl::unexpected(table.error());
  study.stability = std::move(*table);
  study.stability.insert(study.stability.end(), without.begin(), without.end());
  progress(1, "done");
  return study;
}

}  // namespace lumifield
