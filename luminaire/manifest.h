#pragma once

#include <optional>
#include <string>

#include "luminaire/dataset.h"

namespace lumifield {

/// The dataset's files and names, internal to this room; the contract is in luminaire/dataset.h.

constexpr const char* manifest_name = "luminaire.json";
constexpr const char* journal_name = "journal.jsonl";
constexpr const char* cells_name = "cells";
constexpr std::size_t most_manifest_bytes = std::size_t{512} << 20;

/// With its final newline.
std::string to_journal_line(const CellEntry& entry);

/// The manifest's entries and the journal's, in order, none chosen yet.
struct DatasetFolder {
  std::filesystem::path folder;
  Manifest manifest;  ///< its cells are all entries
  std::vector<std::string> notes;
  std::vector<std::string> defaults;
  std::uintmax_t journal_bytes = 0;  ///< that count: without a torn last line
  bool journal_lacks_newline = false;
};
Result<DatasetFolder> read_dataset_folder(const std::filesystem::path& folder);

/// The entries of each cell that has any, oldest first; cells in row-major order.
std::vector<std::vector<CellEntry>> entries_by_cell(const Manifest& manifest);

/// The bytes of an entry's file, checked against its checksum when asked and recorded.
Result<std::string> read_cell_file(const std::filesystem::path& folder, const CellEntry& entry,
                                   const LuminaireGeometry& geometry, bool verify_checksum);

/// "NAME.lumi/cells/r00_c00.1.exr: cell (0, 0)".
std::string place_of(const std::filesystem::path& folder, const CellEntry& entry);

}  // namespace lumifield
