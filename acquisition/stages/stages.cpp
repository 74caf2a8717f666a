#include "acquisition/stage.h"
#include "acquisition/stages/apt_stage.h"
#include "acquisition/stages/grbl_stage.h"
#include "acquisition/stages/replay_stage.h"

namespace lumifield {
namespace {

struct StageKind {
  std::string_view name;
  Result<std::unique_ptr<Stage>> (*open)(const StageSettings&);
  std::vector<DeviceReport> (*find)(const std::string& path);
  DeviceReport (*probe)(const StageSettings&);
};

// A new kind is a file beside this one and a line here.
constexpr StageKind kinds[] = {
    {"grbl", open_grbl_stage, find_grbl_stages, probe_grbl_stage},
    {"apt", open_apt_stage, find_apt_stages, probe_apt_stage},
    {"replay", open_replay_stage, find_replay_stages, probe_replay_stage},
};

Result<StageKind> kind_of(const StageSettings& settings) {
  std::string names;
  for (const StageKind& kind : kinds) {
    if (kind.name == settings.kind) return kind;
    names.append(names.empty() ? "" : ", ").append(kind.name);
  }
  return fail("unknown kind of stage \"" + settings.kind + "\"", "stage.kind", "known kinds: " + names);
}

}  // namespace

Result<Vec2> Stage::slipped_mm(std::stop_token) {
  return fail("has no home switches that can be looked for", info().path,
              "set \"check_home\" to false in the bench file");
}

Result<std::unique_ptr<Stage>> open_stage(const StageSettings& settings) {
  const Result<StageKind> kind = kind_of(settings);
  if (!kind) return tl::unexpected(kind.error());
  return kind->open(settings);
}

Status check_stage_kind(const StageSettings& settings) {
  const Result<StageKind> kind = kind_of(settings);
  return kind ? Status() : tl::unexpected(kind.error());
}

DeviceReport probe_stage(const StageSettings& settings) {
  const Result<StageKind> kind = kind_of(settings);
  if (!kind) return {"stage", {}, settings.path, false, kind.error().what, kind.error().remedy};
  DeviceReport report = kind->probe(settings);
  report.kind = kind->name;
  return report;
}

std::vector<DeviceReport> find_stages(const std::string& path) {
  std::vector<DeviceReport> reports;
  for (const StageKind& kind : kinds)
    for (DeviceReport& report : kind.find(path)) {
      report.kind = kind.name;
      reports.push_back(std::move(report));
    }
  return reports;
}

}  // namespace lumifield
