#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <unistd.h>

#include "app/cli/commands.h"
#include "app/cli/noted_files.h"
#include "app/cli/status_line.h"
#include "app/cli/stop_signal.h"
#include "app/cli/study_report.h"
#include "app/session/study_file.h"
#include "luminaire/dataset.h"
#include "luminaire/manifest.h"
#include "luminaire/scene.h"
#include "renderer/study/reference_cache.h"
#include "renderer/study/run_study.h"
#include "renderer/study/synthetic_luminaire.h"

namespace lumifield {
namespace fs = std::filesystem;

namespace {

/// The folder of the study, made before anything is computed. True: it is new.
Result<bool> prepare_folder(const fs::path& folder, bool force) {
  std::error_code wrong;
  if (!force && fs::exists(folder / study_file_name, wrong))
    return fail("there is a study already", folder.string(), "name another folder, or replace it with --force");
  if (fs::exists(folder / manifest_name, wrong))
    return fail("that is a dataset", folder.string(), "name another folder with --out");
  const bool made = fs::create_directories(folder, wrong);
  if (!wrong && access(folder.c_str(), W_OK) != 0) wrong = std::error_code(errno, std::generic_category());
  if (wrong)
    return fail("a study cannot be written there: " + wrong.message(), folder.string(), "name another with --out");
  return made;
}

Result<StudyLuminaire> read_luminaire(const std::string& text) {
  for (const SyntheticLuminaire& each : table_1_luminaires())
    if (each.name == text) return StudyLuminaire{text, make_luminaire(each), true};
  auto dataset = read_noted_dataset(text);
  if (!dataset) return tl::unexpected(dataset.error());
  fs::path folder = text;
  if (!folder.has_filename()) folder = folder.parent_path();
  return StudyLuminaire{study_luminaire_name(folder.stem().string()), std::move(dataset->light_field)};
}

Result<StudyJob> make_job(const StudyOptions& options) {
  StudyJob job;
  job.quick = options.quick;
  job.ladders_only = options.ladders_only;
  job.cache = options.cache.empty() ? cache_folder() : fs::path(options.cache);
  auto scene = read_noted_scene(options.scene);
  if (!scene) return tl::unexpected(scene.error());
  job.scene = std::move(*scene);
  if (job.scene.name.empty()) job.scene.name = options.scene;

  std::vector<std::string> wanted = options.luminaires;
  if (wanted.empty())
    for (const SyntheticLuminaire& each : table_1_luminaires()) wanted.emplace_back(each.name);
  if (wanted.size() > most_study_luminaires)
    return fail(std::to_string(wanted.size()) + " luminaires are more than a study holds", "--luminaire",
                "name at most " + std::to_string(most_study_luminaires));
  for (const std::string& text : wanted) {
    auto luminaire = read_luminaire(text);
    if (!luminaire) return tl::unexpected(luminaire.error());
    if (std::ranges::count(job.luminaires, luminaire->name, &StudyLuminaire::name) > 0)
      return fail("another luminaire is called '" + luminaire->name + "' too", text, "name each of them once");
    job.luminaires.push_back(std::move(*luminaire));
  }
  return job;
}

Result<Study> run_with_progress(const StudyJob& job) {
  using Clock = std::chrono::steady_clock;
  StatusLine line;
  const Clock::time_point start = Clock::now();
  auto study = run_study(job, [&](double share, const std::string& what) {
    const double elapsed_s = std::chrono::duration<double>(Clock::now() - start).count();
    line.show(share_text(share, elapsed_s) + ", " + what, static_cast<int>(10 * share));
    return !stop_wished();
  });
  line.end();
  return study;
}

Result<Study> make_study(const StudyOptions& options, WriteStudyChart write_chart) {
  const auto job = make_job(options);
  if (!job) return tl::unexpected(job.error());
  auto study = run_with_progress(*job);
  if (!study) return tl::unexpected(study.error());
  if (Status written = write_study(*study, options.out); !written) return tl::unexpected(written.error());
  if (Status drawn = write_chart(*study, options.out); !drawn) return tl::unexpected(drawn.error());
  return study;
}

}  // namespace

int run_study_command(const StudyOptions& options, WriteStudyChart write_chart) {
  const auto start = std::chrono::steady_clock::now();
  const auto made = prepare_folder(options.out, options.force);
  if (!made) return report_error(made.error(), options.json);
  stop_on_signals();
  const auto study = make_study(options, write_chart);
  if (!study) {
    // One that holds something stays.
    std::error_code kept;
    if (*made) fs::remove(options.out, kept);
    return report_error(study.error(), options.json);
  }
  const double time_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  const auto summary = options.json ? study_summary_json : study_summary_text;
  std::fputs(summary(*study, options.out, time_s).c_str(), stdout);
  return exit_done;
}

}  // namespace lumifield
