#include <set>

#include "luminaire/cell_exr.h"
#include "luminaire/dataset.h"
#include "luminaire/file_io.h"
#include "luminaire/half_cells.h"
#include "luminaire/manifest.h"

namespace lumifield {
namespace fs = std::filesystem;
namespace {

/// Checksum, image and attributes of one file.
Status check_entry(const fs::path& folder, const CellEntry& entry, const LuminaireGeometry& geometry) {
  const Result<std::string> bytes = read_cell_file(folder, entry, geometry, true);
  if (!bytes) return tl::unexpected(bytes.error());
  const std::string where = place_of(folder, entry);
  const Result<CellExr> exr = decode_cell_exr(*bytes, geometry, where);
  if (!exr) return tl::unexpected(exr.error());
  if (exr->row.value_or(entry.cell.row) != entry.cell.row ||
      exr->column.value_or(entry.cell.column) != entry.cell.column ||
      exr->generation.value_or(entry.generation) != entry.generation)
    return fail("names cell (" + std::to_string(exr->row.value_or(entry.cell.row)) + ", " +
                    std::to_string(exr->column.value_or(entry.cell.column)) + "), generation " +
                    std::to_string(exr->generation.value_or(entry.generation)) + " in its header",
                where, "two files may have been exchanged");
  return {};
}

void note_absent(const Manifest& manifest, std::vector<std::string>& notes) {
  int checksums = 0, stages = 0, qualities = 0;
  for (const CellEntry& entry : manifest.cells) {
    checksums += entry.sha256.empty();
    stages += !entry.stage_mm;
    qualities += !entry.quality;
  }
  const auto note = [&](int count, const char* what) {
    if (count > 0) notes.push_back(std::to_string(count) + " of " + std::to_string(manifest.cells.size()) + what);
  };
  note(checksums, " entries record no sha256: their files could not be compared");
  note(stages, " entries record no stage_mm");
  note(qualities, " entries record no quality, taken as not determined");
}

/// Files in `cells` that no entry names.
void note_unlisted(const fs::path& folder, const Manifest& manifest, std::vector<std::string>& notes) {
  std::set<fs::path> listed;
  for (const CellEntry& entry : manifest.cells) listed.insert(fs::path(entry.file).lexically_normal());
  std::error_code code;
  std::size_t unlisted = 0;
  for (fs::directory_iterator at(folder / cells_name, code), end; !code && at != end; at.increment(code))
    unlisted += !listed.contains(fs::path(cells_name) / at->path().filename());
  if (unlisted > 0) notes.push_back(std::to_string(unlisted) + " files in cells/ belong to no entry");
}

}  // namespace

Result<CheckReport> check_dataset(const fs::path& folder) {
  Result<DatasetFolder> dataset = read_dataset_folder(folder);
  if (!dataset) return tl::unexpected(dataset.error());
  const LuminaireGeometry& geometry = dataset->manifest.geometry;
  CheckReport report;
  report.notes = std::move(dataset->notes);
  report.notes.insert(report.notes.end(), dataset->defaults.begin(), dataset->defaults.end());
  note_absent(dataset->manifest, report.notes);
  note_unlisted(folder, dataset->manifest, report.notes);

  std::set<CellIndex> measured;
  for (const std::vector<CellEntry>& entries : entries_by_cell(dataset->manifest))
    for (std::size_t k = entries.size(); k-- > 0;) {
      const Status sound = check_entry(folder, entries[k], geometry);
      if (!sound) report.problems.push_back(sound.error().message());
      if (!sound) continue;
      measured.insert(entries[k].cell);
      if (k > 0)
        report.notes.push_back("cell " + to_string(entries[k].cell) + " has " + std::to_string(k) + " earlier entries");
      break;
    }
  const Result<HalfCells> halves = HalfCells::open(folder);
  if (!halves) report.problems.push_back(halves.error().message());
  if (halves) report.problems.insert(report.problems.end(), halves->notes().begin(), halves->notes().end());
  if (halves) report.half_cells = static_cast<int>(halves->size());
  report.coverage.total = geometry.sampling.cells();
  report.coverage.measured = static_cast<int>(measured.size());
  for (int k = 0; k < report.coverage.total; ++k)
    if (!measured.contains(geometry.sampling.index(k))) report.coverage.missing.push_back(geometry.sampling.index(k));
  return report;
}

}  // namespace lumifield
