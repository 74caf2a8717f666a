#include "luminaire/half_cells.h"

#include <algorithm>
#include <cerrno>
#include <optional>
#include <regex>
#include <set>
#include <sstream>
#include <sys/stat.h>
#include <unistd.h>

#include "luminaire/file_io.h"
#include "luminaire/half_cell_file.h"

namespace lumifield {
namespace fs = std::filesystem;
namespace {

constexpr const char* halves_name = "halves";
const std::regex half_name(R"(r(\d{1,6})_c(\d{1,6})\.(\d{1,2})\.raw)");
const std::regex dark_name(R"(dark\.[0-9a-f]{16}\.raw)");

std::string name_of(CellIndex cell, int pass) {
  char text[48];
  std::snprintf(text, sizeof text, "r%02d_c%02d.%d.raw", cell.row, cell.column, pass);
  return text;
}

using Place = std::pair<CellIndex, int>;

std::optional<Place> place_of(const std::string& name) {
  std::smatch parts;
  if (!std::regex_match(name, parts, half_name)) return std::nullopt;
  return Place{{std::stoi(parts[1]), std::stoi(parts[2])}, std::stoi(parts[3])};
}

Result<std::vector<std::string>> names_in(const fs::path& folder) {
  std::vector<std::string> names;
  std::error_code code;
  for (fs::directory_iterator at(folder, code), end; !code && at != end; at.increment(code))
    names.push_back(at->path().filename().string());
  if (code && code != std::errc::no_such_file_or_directory)
    return system_failure("could not be listed", folder, code.value());
  std::ranges::sort(names);
  return names;
}

}  // namespace

Result<HalfCells> HalfCells::open(const fs::path& dataset) {
  HalfCells halves(dataset / halves_name);
  if (Status ok = halves.look_through(); !ok) return tl::unexpected(ok.error());
  return halves;
}

Status HalfCells::look_through() {
  const auto names = names_in(folder_);
  if (!names) return tl::unexpected(names.error());
  for (const std::string& name : *names) {
    const auto place = place_of(name);
    if (!place) continue;
    held_[*place] = {};
    const Result<HalfCell> half = read(place->first, place->second);
    if (half) continue;
    held_.erase(*place);
    notes_.push_back(half.error().message());
  }
  return {};
}

int HalfCells::generation(CellIndex cell, int pass) const {
  const auto found = held_.find({cell, pass});
  return found == held_.end() ? 0 : found->second.generation;
}

std::vector<CellIndex> HalfCells::cells(int pass) const {
  std::vector<CellIndex> cells;
  for (const auto& [place, held] : held_)
    if (place.second == pass) cells.push_back(place.first);
  return cells;
}

/// Its file's name; written unless it is the one at hand.
Result<std::string> HalfCells::add_dark(const std::shared_ptr<const DarkSet>& dark) {
  if (dark == dark_) return dark_name_;
  const std::string bytes = encode_dark_set(*dark);
  const std::string name = "dark." + bytes.substr(0, 16) + ".raw";
  if (Status ok = write_file_durably(folder_ / name, bytes); !ok) return tl::unexpected(ok.error());
  dark_name_ = name;
  dark_ = dark;
  return name;
}

Status HalfCells::add(const HalfCell& half) {
  const std::string where = "cell " + to_string(half.raw.cell) + ", half";
  if (half.raw.passes.size() != 1 || !half.raw.dark)
    return fail("has not one pass with a dark set", where, "scan it again with --resume");
  if (::mkdir(folder_.c_str(), 0777) != 0 && errno != EEXIST)
    return system_failure("could not be made", folder_, errno);
  if (held_.empty())
    if (Status ok = sync_folder(folder_.parent_path()); !ok) return ok;
  const Result<std::string> dark = add_dark(half.raw.dark);
  if (!dark) return fail_in(where, dark.error());
  const std::string name = name_of(half.raw.cell, half.pass);
  if (Status ok = write_file_durably(folder_ / name, encode_half_cell(half, *dark)); !ok)
    return fail_in(where, ok.error());
  held_[{half.raw.cell, half.pass}] = {half.generation, *dark};
  return {};
}

Result<std::shared_ptr<const DarkSet>> HalfCells::read_dark(const std::string& name) {
  if (dark_ && name == dark_name_) return dark_;
  const std::string where = (folder_ / name).string();
  if (!std::regex_match(name, dark_name))
    return fail("names no dark set", where, "go on with the scan by --resume: it is measured again");
  const Result<std::string> bytes = read_file(folder_ / name, most_half_cell_bytes);
  if (!bytes) return tl::unexpected(bytes.error());
  Result<DarkSet> dark = decode_dark_set(*bytes, where);
  if (!dark) return tl::unexpected(dark.error());
  dark_name_ = name;
  dark_ = std::make_shared<const DarkSet>(std::move(*dark));
  return dark_;
}

Result<HalfCell> HalfCells::read(CellIndex cell, int pass) {
  const fs::path file = folder_ / name_of(cell, pass);
  const std::string where = file.string() + ": half of cell " + to_string(cell);
  const auto held = held_.find({cell, pass});
  if (held == held_.end()) return fail("is not there", where, "go on with the scan by --resume: it is measured again");
  const Result<std::string> bytes = read_file(file, most_half_cell_bytes);
  if (!bytes) return tl::unexpected(bytes.error());
  Result<HalfCellFile> read = decode_half_cell(*bytes, where);
  if (!read) return tl::unexpected(read.error());
  if (read->half.raw.cell != cell || read->half.pass != pass)
    return fail("is that of another cell or pass", where, "two files may have been exchanged");
  const auto dark = read_dark(read->dark);
  if (!dark) return tl::unexpected(dark.error());
  read->half.raw.dark = *dark;
  held->second = {read->half.generation, read->dark};
  return std::move(read->half);
}

void HalfCells::forget_stale(const Manifest& manifest) {
  for (const CellEntry& entry : manifest.cells)
    std::erase_if(held_, [&](const auto& half) {
      return half.first.first == entry.cell && half.second.generation <= entry.generation;
    });
}

Status HalfCells::remove_stale(const Manifest& manifest) {
  forget_stale(manifest);
  std::set<CellIndex> whole;
  for (const CellEntry& entry : manifest.cells) whole.insert(entry.cell);
  const auto names = names_in(folder_);
  if (!names) return tl::unexpected(names.error());

  std::set<std::string> named;
  for (const auto& [place, held] : held_) named.insert(held.dark);
  const auto is_unread = [&](const std::string& name) {
    const auto place = place_of(name);
    return place && !held_.contains(*place) && !whole.contains(place->first);
  };
  const bool keeps_dark_sets = std::ranges::any_of(*names, is_unread);

  for (const std::string& name : *names) {
    const auto place = place_of(name);
    const bool left_over = place ? whole.contains(place->first) && !held_.contains(*place)
                                 : name.ends_with(".raw.tmp") ||
                                       (std::regex_match(name, dark_name) && !named.contains(name) && !keeps_dark_sets);
    if (!left_over) continue;
    if (Status ok = remove_file(folder_ / name); !ok) return ok;
  }
  dark_.reset();
  if (held_.empty() && ::rmdir(folder_.c_str()) != 0 && errno != ENOENT && errno != ENOTEMPTY)
    return system_failure("could not be removed", folder_, errno);
  return {};
}

}  // namespace lumifield
