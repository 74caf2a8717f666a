#include <algorithm>
#include <cerrno>
#include <fcntl.h>
#include <iomanip>
#include <regex>
#include <set>
#include <sstream>
#include <stdio.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "luminaire/cell_exr.h"
#include "luminaire/dataset.h"
#include "luminaire/json_reader.h"
#include "luminaire/manifest.h"

namespace lumifield {
namespace fs = std::filesystem;
namespace {

/// `path` without a slash at its end.
fs::path without_slash(const fs::path& path) { return path.has_filename() ? path : path.parent_path(); }

fs::path parent_of(const fs::path& path) {
  const fs::path parent = path.parent_path();
  return parent.empty() ? fs::path(".") : parent;
}

bool is_there(const fs::path& path) {
  std::error_code code;
  return fs::symlink_status(path, code).type() != fs::file_type::not_found;
}

/// Removes a folder that create() began and did not finish; anything else in it keeps it.
void remove_unfinished(const fs::path& folder) {
  const fs::path manifest = folder / manifest_name;
  ::unlink(temporary_name(manifest).c_str());
  ::unlink(manifest.c_str());
  ::rmdir((folder / cells_name).c_str());
  ::rmdir(folder.c_str());
}

Status make_folder(const fs::path& folder) {
  if (::mkdir(folder.c_str(), 0777) != 0) return system_failure("could not be made", folder, errno);
  return {};
}

/// The folder `to` appears at once; an existing one is not replaced.
Status rename_folder(const fs::path& from, const fs::path& to) {
  int failed = ::renameat2(AT_FDCWD, from.c_str(), AT_FDCWD, to.c_str(), RENAME_NOREPLACE);
  // Some file systems cannot promise "no replace"; rename replaces an empty folder at most.
  if (failed != 0 && (errno == EINVAL || errno == ENOSYS)) failed = ::rename(from.c_str(), to.c_str());
  if (failed != 0) return system_failure("could not be made", to, errno);
  Status durable = sync_folder(parent_of(to));
  if (!durable) remove_unfinished(to);
  return durable;
}

Status fill_folder(const fs::path& folder, const Manifest& manifest) {
  if (Status ok = make_folder(folder); !ok) return ok;
  if (Status ok = make_folder(folder / cells_name); !ok) return ok;
  return write_file_durably(folder / manifest_name, to_json(manifest));
}

/// Names the folder that is to be, not the one it is made as.
Error renamed(Error error, const fs::path& from, const fs::path& to) {
  if (error.where.starts_with(from.string())) error.where.replace(0, from.string().size(), to.string());
  return error;
}

/// Removes files in `cells` that carry our names but no entry, and temporary ones: an interrupted add() left them.
Status remove_leftovers(const fs::path& folder, const Manifest& all_entries) {
  static const std::regex ours(R"(r\d+_c\d+\.\d+\.exr(\.tmp)?)");
  if (Status ok = remove_file(temporary_name(folder / manifest_name)); !ok) return ok;
  if (!is_there(folder / cells_name)) return make_folder(folder / cells_name);
  if (const auto inside = path_inside(folder, cells_name, (folder / cells_name).string()); !inside)
    return tl::unexpected(inside.error());
  std::set<fs::path> listed;
  for (const CellEntry& entry : all_entries.cells) listed.insert(fs::path(entry.file).lexically_normal());
  std::error_code code;
  std::vector<fs::path> leftovers;
  for (fs::directory_iterator at(folder / cells_name, code), end; !code && at != end; at.increment(code)) {
    const fs::path name = at->path().filename();
    if (std::regex_match(name.string(), ours) && !listed.contains(fs::path(cells_name) / name))
      leftovers.push_back(at->path());
  }
  if (code) return system_failure("could not be listed", folder / cells_name, code.value());
  for (const fs::path& file : leftovers)
    if (Status ok = remove_file(file); !ok) return ok;
  return {};
}

}  // namespace

Status DatasetWriter::lock(const fs::path& folder) {
  lock_ = FileHandle(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (!lock_) return system_failure("could not be opened", folder, errno);
  if (::flock(lock_.get(), LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK) return {};
  return fail("is being written by another program", folder.string(), "wait until that scan has ended");
}

Result<DatasetWriter> DatasetWriter::create(const fs::path& given, Manifest manifest) {
  const fs::path folder = without_slash(given);
  if (is_there(folder)) return fail("exists already", folder.string(), "choose another name, or go on with --resume");
  if (!manifest.cells.empty()) return fail("a new dataset has no cells yet", folder.string());
  const Result<Manifest> read_back = parse_manifest(to_json(manifest), (folder / manifest_name).string());
  if (!read_back) return tl::unexpected(read_back.error());
  const fs::path unfinished = fs::path(folder) += ".unfinished";
  remove_unfinished(unfinished);
  DatasetWriter writer(folder, std::move(manifest));
  Status done = fill_folder(unfinished, writer.manifest_);
  if (done) done = writer.lock(unfinished);
  if (done) done = rename_folder(unfinished, folder);
  if (done) return writer;
  remove_unfinished(unfinished);
  return fail_in("new dataset", renamed(done.error(), unfinished, folder));
}

Result<DatasetWriter> DatasetWriter::resume(const fs::path& given, const LuminaireGeometry& expected) {
  DatasetWriter writer(without_slash(given), {});
  if (Status ok = writer.lock(writer.folder_); !ok) return tl::unexpected(ok.error());
  Result<DatasetFolder> dataset = read_dataset_folder(writer.folder_);
  if (!dataset) return tl::unexpected(dataset.error());
  if (const auto difference = first_difference(dataset->manifest.geometry, expected))
    return fail("its " + *difference, (writer.folder_ / manifest_name).string(),
                "resume with the bench and the plan it was begun with");
  if (Status ok = remove_leftovers(writer.folder_, dataset->manifest); !ok) return tl::unexpected(ok.error());
  writer.journal_bytes_ = dataset->journal_bytes;
  writer.notes_ = std::move(dataset->notes);
  const Manifest all = std::move(dataset->manifest);
  writer.manifest_ = {all.name, all.geometry, {}, all.provenance_json};
  for (const std::vector<CellEntry>& entries : entries_by_cell(all))
    for (const CellEntry& entry : entries) {
      int& generation = writer.generations_[entry.cell];
      generation = std::max(generation, entry.generation);
      const Result<std::string> bytes = read_cell_file(writer.folder_, entry, all.geometry, true);
      if (bytes && !bytes->empty())
        writer.take(entry);
      else
        writer.notes_.push_back((bytes ? place_of(writer.folder_, entry) + ": is empty" : bytes.error().message()));
    }
  if (dataset->journal_lacks_newline) {
    const fs::path journal = writer.folder_ / journal_name;
    if (Status ok = append_durably(journal, "\n", writer.journal_bytes_); !ok) return tl::unexpected(ok.error());
    ++writer.journal_bytes_;
  } else if (Status ok = writer.open_journal(); !ok) {
    return tl::unexpected(ok.error());
  }
  return writer;
}

/// Cuts a torn last line.
Status DatasetWriter::open_journal() {
  const fs::path journal = folder_ / journal_name;
  std::error_code code;
  const std::uintmax_t bytes = fs::file_size(journal, code);
  return !code && bytes > journal_bytes_ ? cut_file(journal, journal_bytes_) : Status{};
}

/// Lets `entry` count instead of its cell's earlier one.
void DatasetWriter::take(const CellEntry& entry) {
  const auto before = [](const CellEntry& a, const CellEntry& b) { return a.cell < b.cell; };
  const auto at = std::lower_bound(manifest_.cells.begin(), manifest_.cells.end(), entry, before);
  if (at == manifest_.cells.end() || at->cell != entry.cell) {
    manifest_.cells.insert(at, entry);
  } else {
    superseded_.push_back(at->file);
    *at = entry;
  }
}

/// A name that no file has yet.
std::string DatasetWriter::next_file(CellIndex cell, int& generation) const {
  const auto last = generations_.find(cell);
  generation = last == generations_.end() ? 0 : last->second;
  std::string file;
  do {
    std::ostringstream name;
    name << cells_name << "/r" << std::setfill('0') << std::setw(2) << cell.row << "_c" << std::setw(2) << cell.column
         << "." << ++generation << ".exr";
    file = name.str();
  } while (is_there(folder_ / file));
  return file;
}

Result<CellEntry> DatasetWriter::add(CellIndex cell, const CellImage& image, const Vec2& stage_mm) {
  const LuminaireGeometry& geometry = manifest_.geometry;
  const std::string where = "cell " + to_string(cell);
  if (Status ok = check_cell(geometry, cell, image); !ok) return tl::unexpected(ok.error());
  CellEntry entry;
  entry.cell = cell;
  entry.file = next_file(cell, entry.generation);
  entry.stage_mm = stage_mm;
  entry.quality = image.quality;
  const Result<std::string> bytes = encode_cell_exr(image, geometry, cell, entry.generation);
  if (!bytes) return tl::unexpected(bytes.error());
  entry.sha256 = sha256_hex(*bytes);
  // What is written must be readable.
  const std::string line = to_journal_line(entry);
  if (const auto read_back = parse_journal_line(line, geometry, where); !read_back)
    return tl::unexpected(read_back.error());

  const fs::path file = folder_ / entry.file;
  Status done = write_file_durably(file, *bytes);
  if (done) done = append_durably(folder_ / journal_name, line, journal_bytes_);
  if (!done) {
    // A journal that could not be cut back still names the file.
    std::error_code code;
    const std::uintmax_t bytes_left = fs::file_size(folder_ / journal_name, code);
    if (code || bytes_left <= journal_bytes_) ::unlink(file.c_str());
    return fail_in(where, done.error());
  }
  journal_bytes_ += line.size();
  generations_[cell] = entry.generation;
  take(entry);
  return entry;
}

void DatasetWriter::set_provenance(std::string json_object) { manifest_.provenance_json = std::move(json_object); }

Status DatasetWriter::record_provenance(std::string json_object) {
  set_provenance(std::move(json_object));
  return close();
}

Status DatasetWriter::close() {
  const auto provenance = JsonDocument::parse(manifest_.provenance_json, "provenance");
  if (!provenance) return tl::unexpected(provenance.error());
  if (Status ok = write_file_durably(folder_ / manifest_name, to_json(manifest_)); !ok) return ok;
  // The journal goes before the files it names.
  if (Status ok = remove_file(folder_ / journal_name); !ok) return ok;
  if (Status ok = sync_folder(folder_); !ok) return ok;
  journal_bytes_ = 0;
  std::set<fs::path> listed;
  for (const CellEntry& entry : manifest_.cells) listed.insert(fs::path(entry.file).lexically_normal());
  for (const std::string& name : superseded_) {
    const Result<fs::path> file = path_inside(folder_, name, name);
    if (!file || listed.contains(fs::path(name).lexically_normal())) continue;
    if (Status ok = remove_file(*file); !ok) return ok;
  }
  superseded_.clear();
  return sync_folder(folder_ / cells_name);
}

}  // namespace lumifield
