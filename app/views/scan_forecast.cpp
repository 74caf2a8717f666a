#include "app/views/scan_forecast.h"

#include <optional>
#include <set>
#include <system_error>

#include "acquisition/scan/motion_time.h"
#include "acquisition/scan/scan_plan.h"
#include "app/session/disk_room.h"
#include "app/session/precedent.h"
#include "app/session/stored_bytes.h"
#include "app/views/scan_words.h"
#include "calibration/develop.h"
#include "calibration/raw_checks.h"
#include "luminaire/dataset.h"
#include "luminaire/scene.h"

namespace lumifield {

namespace {

QString text(const Error& error) { return QString::fromStdString(error.message()); }

void note(ScanForecast& forecast, const std::vector<std::string>& defaults) {
  for (const std::string& one : defaults) forecast.notes << QString::fromStdString(one);
}

/// A file that is named and read, or a fault of its field.
template <class Value, class Read>
std::optional<Value> read_file(ScanForecast& to, NewScanField field, const std::filesystem::path& file, Read read) {
  std::vector<std::string> defaults;
  Result<Value> value = read(file, &defaults, ReaderNotes::all);
  if (!value) {
    to.faults[field] = text(value.error());
    return std::nullopt;
  }
  note(to, defaults);
  return std::move(*value);
}

/// The cells of a dataset that is there already.
std::set<CellIndex> read_done(ScanForecast& to, const std::filesystem::path& out, const Bench& bench,
                              const Plan& plan) {
  const Result<DatasetIndex> index = read_dataset_index(out);
  if (!index) {
    to.faults[NewScanField::out] = "is there and cannot be gone on with; choose another name. " + text(index.error());
    return {};
  }
  if (const auto same = check_same_measurement(index->manifest.provenance_json, bench, plan); !same) {
    to.faults[NewScanField::out] = "was measured otherwise; choose another name. " + text(same.error());
    return {};
  }
  std::set<CellIndex> done;
  for (const CellEntry& entry : index->manifest.cells) done.insert(entry.cell);
  return done;
}

std::set<CellIndex> look_at_out(ScanForecast& to, std::filesystem::path out, const Bench& bench, const Plan& plan) {
  if (!out.has_filename()) out = out.parent_path();
  std::error_code code;
  const std::filesystem::path parent = std::filesystem::absolute(out, code).parent_path();
  if (!std::filesystem::is_directory(parent, code)) {
    to.faults[NewScanField::out] =
        QString::fromStdString(parent.string()) + " is not there: make that folder, or choose another";
    return {};
  }
  if (const Result<DiskRoom> disk = disk_room(parent)) to.free_bytes = disk->free_bytes;
  return std::filesystem::exists(out, code) ? read_done(to, out, bench, plan) : std::set<CellIndex>();
}

void plan_scan(ScanForecast& to, const Bench& bench, const Plan& plan, const std::set<CellIndex>& done) {
  to.columns = plan.columns;
  to.rows = plan.rows;
  if (const Status fits = check_bench(bench, plan); !fits) to.faults[NewScanField::bench] = text(fits.error());
  const Result<ScanPlan> steps = make_scan_plan(bench, plan, done);
  if (!steps) {
    to.faults[NewScanField::plan] = text(steps.error());
    return;
  }
  to.done = static_cast<int>(done.size());
  to.to_do = steps->cells;
  to.predicted_s = steps->predicted_s;
  to.assumed_mm_s = bench.stage.rapid_mm_s > 0 ? 0 : stage_speed(bench.stage).rapid_mm_s;
  to.disk_bytes = stored_bytes(bench, plan, steps->cells);
}

}  // namespace

ScanForecast forecast(const NewScan& scan) {
  ScanForecast to;
  if (scan.bench.empty()) to.faults[NewScanField::bench] = "choose the bench file";
  if (scan.plan.empty()) to.faults[NewScanField::plan] = "choose the plan file";
  if (scan.out.empty()) to.faults[NewScanField::out] = "choose where the luminaire is stored";
  std::optional<Bench> bench;
  std::optional<Plan> plan;
  if (!scan.bench.empty()) bench = read_file<Bench>(to, NewScanField::bench, scan.bench, read_bench);
  if (!scan.plan.empty()) plan = read_file<Plan>(to, NewScanField::plan, scan.plan, read_plan);
  if (!scan.scene.empty()) read_file<Scene>(to, NewScanField::scene, scan.scene, read_scene);
  if (!bench || !plan) return to;
  const std::set<CellIndex> done = scan.out.empty() ? std::set<CellIndex>() : look_at_out(to, scan.out, *bench, *plan);
  plan_scan(to, *bench, *plan, done);
  return to;
}

QString forecast_text(const ScanForecast& f) {
  if (f.columns == 0) return {};
  QString cells = QString("%1 × %2 = %3 cells").arg(f.columns).arg(f.rows).arg(f.columns * f.rows);
  if (f.done > 0) cells += QString(", %1 of them measured already").arg(f.done);
  if (!f.usable()) return cells;
  if (f.to_do == 0) return cells + ": nothing is left to scan";
  QString disk = "up to " + bytes_text(f.disk_bytes);
  if (f.free_bytes >= 0)
    disk += f.free_bytes < f.disk_bytes ? ", but only " + bytes_text(f.free_bytes) + " are left on that disk"
                                        : " of the " + bytes_text(f.free_bytes) + " left on that disk";
  const QString speed = f.assumed_mm_s > 0
                            ? QString("%1 mm/s, assumed since the bench file gives no speed").arg(f.assumed_mm_s)
                            : QString("the stage's speed");
  return QString("%1\nabout %2 (min:s), from the plan's exposures and %3\n%4")
      .arg(cells, duration_text(f.predicted_s), speed, disk);
}

}  // namespace lumifield
