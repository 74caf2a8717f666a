#include <cstdio>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <regex>

#include "acquisition/scan/scan_rules.h"
#include "app/cli/commands.h"
#include "app/cli/noted_files.h"
#include "app/cli/print_result.h"
#include "app/session/provenance.h"
#include "app/session/study_file.h"
#include "luminaire/bench.h"
#include "luminaire/dataset.h"
#include "luminaire/file_io.h"
#include "luminaire/json_reader.h"
#include "luminaire/manifest.h"
#include "luminaire/plan.h"
#include "luminaire/scene.h"
#include "renderer/environment/lat_long.h"

namespace lumifield {

namespace {

struct Finding {
  std::string path, kind;
  std::vector<std::string> problems, notes;
  std::string detail;
  bool there = true;
};

/// What cannot be found, and a folder without manifest, is no unsound dataset but none.
Finding absent(const std::string& path, std::string why) {
  return {path, "", {Error{std::move(why), path, "check the path"}.message()}, {}, {}, false};
}

/// Of one kind are warnings that differ by their numbers alone.
std::string kind_of(const std::string& warning) {
  static const std::regex number("[-+]?[0-9][-+0-9.e]*");
  return std::regex_replace(warning, number, "…");
}

/// How good the cells are by what their scan has recorded.
void tell_quality(Finding& finding) {
  const Result<DatasetIndex> index = read_dataset_index(finding.path);
  if (!index) return;  // a problem that is told
  const std::vector<CellEntry>& cells = index->manifest.cells;
  std::map<std::string, int> kinds;
  int warned = 0;
  for (const CellEntry& entry : cells) {
    if (!entry.quality || entry.quality->warnings.empty()) continue;
    ++warned;
    for (const std::string& warning : entry.quality->warnings) ++kinds[kind_of(warning)];
  }
  finding.detail += ", " + std::to_string(warned) + " with warnings";
  for (const auto& [kind, count] : kinds)
    finding.notes.push_back("warning of " + std::to_string(count) + " cells: " + kind);
  if (const auto recorded = largest_drift(index->manifest.provenance_json)) {
    char text[96];
    std::snprintf(text, sizeof text, ", largest drift %+.3g %% (the plan's limit: %.3g %%)", 100 * recorded->drift,
                  100 * recorded->limit);
    finding.detail += text;
  }
}

Finding check_folder(const std::string& path) {
  std::error_code wrong;
  const std::string within = datasets_within(path);
  if (!std::filesystem::exists(std::filesystem::path(path) / manifest_name, wrong) && !wrong)
    return absent(path, within.empty() ? "there is no dataset there, only a folder without luminaire.json"
                                       : "there is no dataset there, but a folder that holds " + within);
  Finding finding{path, "dataset", {}, {}, {}, true};
  Result<CheckReport> report = check_dataset(path);
  if (!report) {
    finding.problems.push_back(report.error().message());
    return finding;
  }
  finding.problems = report->problems;
  finding.notes = report->notes;
  finding.detail =
      std::to_string(report->coverage.measured) + " of " + std::to_string(report->coverage.total) + " cells";
  if (report->half_cells > 0)
    finding.detail += ", " + std::to_string(report->half_cells) +
                      (report->half_cells == 1 ? " half cell" : " half cells") +
                      " (of one pass: the slide for the next is to be put in, and the scan gone on with by --resume)";
  tell_quality(finding);
  return finding;
}

/// The file's own "format", empty when it cannot be told.
Result<std::string> format_of(const std::string& path) {
  constexpr std::uintmax_t largest_bytes = 64u << 20;
  std::error_code wrong;
  const auto bytes = std::filesystem::file_size(path, wrong);
  if (wrong) return fail("cannot be read: " + wrong.message(), path, "check the path");
  if (bytes > largest_bytes) return fail("is larger than any bench, plan, scene or study", path, "check the path");
  const Result<std::string> text = read_file(path, largest_bytes);
  if (!text) return tl::unexpected(text.error());
  // Its own reader is stricter about how many values it may hold.
  Result<JsonDocument> document = JsonDocument::parse(*text, path, {.bytes = largest_bytes, .values = largest_bytes});
  if (!document) return tl::unexpected(document.error());
  std::string format = document->root()["format"].text();
  if (!document->status())
    return fail("is no JSON object with a \"format\"", path,
                "name a dataset folder, a bench, a plan, a scene or a study");
  return format;
}

template <class T>
void take(Finding& finding, const Result<T>& read) {
  if (!read) finding.problems.push_back(read.error().message());
}

void check_bench(Finding& finding) {
  const Result<Bench> bench = read_bench(finding.path, &finding.notes);
  take(finding, bench);
  if (!bench) return;
  if (const Status usable = check_devices(*bench); !usable) finding.problems.push_back(usable.error().message());
}

/// With its environment, which is read late, and of which the scene itself says nothing.
void check_scene(Finding& finding) {
  const Result<Scene> scene = read_scene(finding.path, &finding.notes);
  take(finding, scene);
  if (scene && scene->environment) take(finding, LatLong::read(*scene->environment));
}

Finding check_file(const std::string& path) {
  Finding finding{path, "file", {}, {}, {}, true};
  const Result<std::string> format = format_of(path);
  if (!format) {
    finding.problems.push_back(format.error().message());
    return finding;
  }
  finding.kind = *format;
  if (*format == "lumifield-bench")
    check_bench(finding);
  else if (*format == "lumifield-plan")
    take(finding, read_plan(path, &finding.notes));
  else if (*format == "lumifield-scene")
    check_scene(finding);
  else if (*format == "lumifield-study")
    take(finding, read_study(path));
  else
    finding.problems.push_back(Error{"format '" + *format + "' is not known", path,
                                     "name a dataset folder, a bench, a plan, a scene or a study"}
                                   .message());
  return finding;
}

void print(const Finding& finding) {
  if (!finding.there) {
    std::printf("%s\n", finding.problems.front().c_str());
    return;
  }
  std::printf("%s: %s%s%s\n", finding.path.c_str(), finding.problems.empty() ? "sound" : "NOT sound",
              finding.detail.empty() ? "" : ", ", finding.detail.c_str());
  for (const std::string& problem : finding.problems) std::printf("  problem: %s\n", problem.c_str());
  for (const std::string& note : finding.notes) std::printf("  note: %s\n", note.c_str());
}

Finding check(const std::string& path) {
  std::error_code wrong;
  const std::filesystem::file_status status = std::filesystem::status(path, wrong);
  if (status.type() == std::filesystem::file_type::not_found)
    return absent(path, "there is no dataset and no file there");
  return std::filesystem::is_directory(status) ? check_folder(path) : check_file(path);
}

}  // namespace

int run_check(const CheckOptions& options) {
  bool sound = true;
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const std::string& path : options.paths) {
    const Finding finding = check(path);
    sound = sound && finding.problems.empty();
    if (!options.json) print(finding);
    list.push_back({{"path", finding.path},
                    {"there", finding.there},
                    {"kind", finding.kind},
                    {"sound", finding.problems.empty()},
                    {"problems", finding.problems},
                    {"notes", finding.notes},
                    {"detail", finding.detail}});
  }
  if (options.json) std::printf("%s\n", dump_json({{"sound", sound}, {"checked", list}}).c_str());
  return sound ? exit_done : exit_failed;
}

}  // namespace lumifield
