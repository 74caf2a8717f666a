#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "luminaire/file_io.h"
#include "luminaire/light_field.h"

namespace lumifield {

/// A luminaire on disk, `NAME.lumi/`: `luminaire.json` (manifest), `journal.jsonl` (one line per durable cell since the
/// manifest), `cells/rRR_cCC.G.exr` (R row, C column, G generation; one channel per manifest channel, HALF or FLOAT,
/// and optionally `<channel>.variance`). Files are never overwritten: a retake is the next generation.
///
/// A cell counts when its file and its line are on disk: temporary name, fsync, rename, folder fsync, then the line,
/// fsync. Reading takes the manifest's cells, then the journal's in order, the last valid one per cell; a torn last
/// line is ignored and reported. A half-scanned dataset opens everywhere a whole one does.

/// One entry of the manifest's `cells`, and exactly one line of the journal.
struct CellEntry {
  CellIndex cell;
  std::string file;  ///< relative to the dataset's folder
  int generation = 1;
  std::string sha256;  ///< lower-case hex, empty = not recorded
  std::optional<Vec2> stage_mm;
  std::optional<Quality> quality;
};

struct Manifest {
  std::string name;
  LuminaireGeometry geometry;
  std::vector<CellEntry> cells;
  std::string provenance_json = "{}";  ///< an object, kept as it is: program, bench, plan, times
};

/// Names the first member in which `a` is not `b`, in the manifest's words; empty when they describe one luminaire.
std::optional<std::string> first_difference(const LuminaireGeometry& a, const LuminaireGeometry& b);

/// Defaults taken for absent members are told in `notes`, one text each.
Result<Manifest> parse_manifest(std::string_view json, std::string_view name,
                                std::vector<std::string>* notes = nullptr);
std::string to_json(const Manifest& manifest);
Result<CellEntry> parse_journal_line(std::string_view line, const LuminaireGeometry& geometry, std::string_view name);

/// What a folder holds: the manifest with the journal applied. `notes` are things a reader should be told (a torn
/// line).
struct DatasetIndex {
  std::filesystem::path folder;
  Manifest manifest;
  std::vector<std::string> notes;
};
Result<DatasetIndex> read_dataset_index(const std::filesystem::path& folder);

/// Reads and checks one cell's file: size, channels, finite values; its checksum when `verify_checksum` and recorded.
Result<CellImage> read_cell(const DatasetIndex& index, const CellEntry& entry, bool verify_checksum = false);

/// Reads all of it, checksums verified. Where a cell's last file is damaged an earlier generation is read and noted; a
/// cell without any sound file is an error. `notes` as above.
struct Dataset {
  DatasetIndex index;
  LightField light_field;
};
Result<Dataset> read_dataset(const std::filesystem::path& folder);

/// Every file against its checksum, every number against its range.
struct CheckReport {
  Coverage coverage;
  int half_cells = 0;                 ///< passes of cells that are not whole yet (luminaire/half_cells.h)
  std::vector<std::string> problems;  ///< empty = sound
  std::vector<std::string> notes;     ///< defaults taken, torn lines ignored
};
Result<CheckReport> check_dataset(const std::filesystem::path& folder);

/// Writes a dataset cell by cell, durably. Thread-bound (the store thread).
class DatasetWriter {
 public:
  /// Makes a new folder with its manifest, at once or not at all. Refuses an existing folder.
  static Result<DatasetWriter> create(const std::filesystem::path& folder, Manifest manifest);
  /// Opens a folder to go on; refuses one whose geometry differs from `expected`, and one that another writer holds.
  /// Verifies the cells' checksums: a cell without a sound file counts as unmeasured. Removes what an interrupted
  /// writer left: a torn last line, temporary files, cell files without their line.
  static Result<DatasetWriter> resume(const std::filesystem::path& folder, const LuminaireGeometry& expected);

  /// The cell is durable when this returns. The generation is the next free one of that cell. On failure nothing of it
  /// is left and the writer may go on.
  Result<CellEntry> add(CellIndex cell, const CellImage& image, const Vec2& stage_mm);
  /// Writes the manifest with all cells (temporary, fsync, rename), then removes the journal and superseded files.
  Status close();
  /// The manifest on disk lists all cells, and nothing is left to remove.
  bool is_closed() const { return journal_bytes_ == 0 && superseded_.empty(); }
  /// Replaces the manifest's provenance, written by close().
  void set_provenance(std::string json_object);
  /// Replaces it on disk: durable when this returns, with all cells so far. The writer may go on.
  Status record_provenance(std::string json_object);

  const std::filesystem::path& folder() const { return folder_; }
  /// Its cells are the valid ones, one entry each, in row-major order.
  const Manifest& manifest() const { return manifest_; }
  /// What resume() passed over: a torn line, a damaged file.
  const std::vector<std::string>& notes() const { return notes_; }

 private:
  DatasetWriter(std::filesystem::path folder, Manifest manifest)
      : folder_(std::move(folder)), manifest_(std::move(manifest)) {}
  Status lock(const std::filesystem::path& folder);
  Status open_journal();
  std::string next_file(CellIndex cell, int& generation) const;
  void take(const CellEntry& entry);

  std::filesystem::path folder_;
  Manifest manifest_;
  FileHandle lock_;  ///< an advisory lock on the folder: one writer at a time
  std::map<CellIndex, int> generations_;
  std::vector<std::string> superseded_;
  std::vector<std::string> notes_;
  std::uintmax_t journal_bytes_ = 0;
};

}  // namespace lumifield
