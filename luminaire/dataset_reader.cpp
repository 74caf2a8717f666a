#include <functional>
#include <map>
#include <unistd.h>

#include "luminaire/cell_exr.h"
#include "luminaire/dataset.h"
#include "luminaire/file_io.h"
#include "luminaire/manifest.h"

namespace lumifield {
namespace fs = std::filesystem;
namespace {

constexpr std::uintmax_t most_journal_bytes = std::uintmax_t{1} << 30;

/// Appends the journal's entries; a line that is none is ignored and noted. A torn last line does not count.
void apply_journal(std::string_view text, DatasetFolder& dataset) {
  const std::string name = (dataset.folder / journal_name).string();
  std::size_t at = 0;
  for (int number = 1; at < text.size(); ++number) {
    const std::size_t newline = text.find('\n', at);
    const bool last = newline == std::string_view::npos || newline + 1 == text.size();
    const std::string_view line = text.substr(at, newline == std::string_view::npos ? newline : newline - at);
    at = newline == std::string_view::npos ? text.size() : newline + 1;
    const bool blank = line.find_first_not_of(" \t\r") == std::string_view::npos;
    Result<CellEntry> entry = fail("", "");
    if (!blank) entry = parse_journal_line(line, dataset.manifest.geometry, name + ": line " + std::to_string(number));
    if (entry) dataset.manifest.cells.push_back(std::move(*entry));
    if (entry || blank || !last) dataset.journal_bytes = at;
    if (entry && newline == std::string_view::npos) dataset.journal_lacks_newline = true;
    if (!entry && !blank)
      dataset.notes.push_back((last ? "a torn last line is ignored: " : "a damaged line is ignored: ") +
                              entry.error().message());
  }
}

using Validity = std::function<Status(const CellEntry&)>;

/// The last valid entry; the last one, and its fault in `fault`, when none is. What was passed over is noted.
CellEntry last_valid(const std::vector<CellEntry>& entries, const Validity& check, std::vector<std::string>& notes,
                     std::optional<Error>& fault) {
  for (std::size_t k = entries.size(); k-- > 0;) {
    const Status valid = check(entries[k]);
    if (valid) {
      fault.reset();
      return entries[k];
    }
    if (!fault) fault = valid.error();
    if (k > 0) notes.push_back(valid.error().message() + "; an earlier generation is read instead");
  }
  return entries.back();
}

/// That all cells together fit the machine's memory.
Status check_memory(const DatasetFolder& dataset, std::size_t cells) {
  const LuminaireGeometry& g = dataset.manifest.geometry;
  const double needed = static_cast<double>(cells) * static_cast<double>(g.measurement.pixels()) *
                        static_cast<double>(g.channels.size()) * 2 * sizeof(float);
  const double available = static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGESIZE));
  constexpr double gigabyte = 1e9;
  if (needed > available)
    return fail("may need " + std::to_string(needed / gigabyte) + " GB of memory, the machine has " +
                    std::to_string(available / gigabyte),
                dataset.folder.string(), "open it on a larger machine");
  return {};
}

}  // namespace

std::string place_of(const fs::path& folder, const CellEntry& entry) {
  return (folder / entry.file).string() + ": cell " + to_string(entry.cell);
}

std::vector<std::vector<CellEntry>> entries_by_cell(const Manifest& manifest) {
  std::map<CellIndex, std::vector<CellEntry>> cells;
  for (const CellEntry& entry : manifest.cells) cells[entry.cell].push_back(entry);
  std::vector<std::vector<CellEntry>> all;
  for (auto& [cell, entries] : cells) all.push_back(std::move(entries));
  return all;
}

Result<DatasetFolder> read_dataset_folder(const fs::path& folder) {
  const fs::path file = folder / manifest_name;
  const Result<std::string> text = read_file(file, most_manifest_bytes);
  if (!text) return tl::unexpected(text.error());
  DatasetFolder dataset;
  dataset.folder = folder;
  Result<Manifest> manifest = parse_manifest(*text, file.string(), &dataset.defaults);
  if (!manifest) return tl::unexpected(manifest.error());
  dataset.manifest = std::move(*manifest);
  std::error_code code;
  if (fs::symlink_status(folder / journal_name, code).type() == fs::file_type::not_found) return dataset;
  const Result<std::string> journal = read_file(folder / journal_name, most_journal_bytes);
  if (!journal) return tl::unexpected(journal.error());
  apply_journal(*journal, dataset);
  return dataset;
}

Result<std::string> read_cell_file(const fs::path& folder, const CellEntry& entry, const LuminaireGeometry& geometry,
                                   bool verify_checksum) {
  const std::string where = place_of(folder, entry);
  const Result<fs::path> path = path_inside(folder, entry.file, where);
  if (!path) return tl::unexpected(path.error());
  // Four times the values and variances as FLOAT: room for channels of other programs.
  const std::uintmax_t most = geometry.measurement.pixels() * geometry.channels.size() * 32 + (std::uintmax_t{1} << 20);
  Result<std::string> bytes = read_file(*path, most);
  if (!bytes) {
    bytes.error().where = where;
    return bytes;
  }
  if (verify_checksum && !entry.sha256.empty() && sha256_hex(*bytes) != entry.sha256)
    return fail("is not what was written: its SHA-256 differs", where, "measure the cell again, or copy its file anew");
  return bytes;
}

Result<DatasetIndex> read_dataset_index(const fs::path& folder) {
  Result<DatasetFolder> dataset = read_dataset_folder(folder);
  if (!dataset) return tl::unexpected(dataset.error());
  DatasetIndex index{folder, std::move(dataset->manifest), std::move(dataset->notes)};
  const Validity exists = [&](const CellEntry& entry) -> Status {
    const std::string where = place_of(folder, entry);
    const Result<fs::path> path = path_inside(folder, entry.file, where);
    if (!path) return tl::unexpected(path.error());
    std::error_code code;
    if (!fs::is_regular_file(*path, code) || fs::file_size(*path, code) == 0)
      return fail("is missing or empty", where, "measure the cell again");
    return {};
  };
  std::vector<CellEntry> chosen;
  for (const std::vector<CellEntry>& entries : entries_by_cell(index.manifest)) {
    std::optional<Error> fault;
    chosen.push_back(last_valid(entries, exists, index.notes, fault));
    if (fault) index.notes.push_back(fault->message());
  }
  index.manifest.cells = std::move(chosen);
  return index;
}

Result<CellImage> read_cell(const DatasetIndex& index, const CellEntry& entry, bool verify_checksum) {
  const LuminaireGeometry& geometry = index.manifest.geometry;
  const Result<std::string> bytes = read_cell_file(index.folder, entry, geometry, verify_checksum);
  if (!bytes) return tl::unexpected(bytes.error());
  Result<CellExr> cell = decode_cell_exr(*bytes, geometry, place_of(index.folder, entry));
  if (!cell) return tl::unexpected(cell.error());
  if (entry.quality) cell->image.quality = *entry.quality;
  return std::move(cell->image);
}

Result<Dataset> read_dataset(const fs::path& folder) {
  Result<DatasetFolder> opened = read_dataset_folder(folder);
  if (!opened) return tl::unexpected(opened.error());
  const std::vector<std::vector<CellEntry>> cells = entries_by_cell(opened->manifest);
  if (Status ok = check_memory(*opened, cells.size()); !ok) return tl::unexpected(ok.error());
  LightField empty(opened->manifest.geometry);
  Dataset dataset{{folder, std::move(opened->manifest), std::move(opened->notes)}, std::move(empty)};
  dataset.index.manifest.cells.clear();
  const Validity read = [&](const CellEntry& entry) -> Status {
    Result<CellImage> image = read_cell(dataset.index, entry, true);
    if (!image) return tl::unexpected(image.error());
    return dataset.light_field.add(entry.cell, std::move(*image));
  };
  for (const std::vector<CellEntry>& entries : cells) {
    std::optional<Error> fault;
    CellEntry entry = last_valid(entries, read, dataset.index.notes, fault);
    if (fault) return tl::unexpected(*fault);
    dataset.index.manifest.cells.push_back(std::move(entry));
  }
  return dataset;
}

}  // namespace lumifield
