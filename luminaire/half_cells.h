#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "luminaire/dataset.h"
#include "luminaire/raw_image.h"

namespace lumifield {

/// One pass of a cell whose other passes are still to come, since the operator changes the slide (PassChange).
/// Value type.
struct HalfCell {
  int pass = 0;        ///< index into bench.filter.passes; the file does not know its name
  int generation = 1;  ///< of the whole cell that it is to be part of
  RawCell raw;         ///< of this one pass, with its dark set
};

/// The half cells of a dataset, in `NAME.lumi/halves/`, raw, so that a cell that becomes whole is developed as if all
/// its passes had been taken together.
///
/// `rRR_cCC.P.raw` is pass P of cell (R, C), `dark.NNNN.raw` a dark set, named by its checksum, for the half cells that
/// name it. Each file is one line with the SHA-256 of the rest, one line of JSON (place, figures, frames), and the
/// frames' DN in order, 16 bits, little-endian. A half cell counts when its file is there under its name (temporary
/// name, fsync, rename, folder fsync); one taken again replaces it so. It is stale once a cell of its generation, or a
/// later one, is stored. Thread-bound.
class HalfCells {
 public:
  /// Of a dataset; to be written to by one alone. Reads and verifies every file: what is damaged is noted and does not
  /// count.
  static Result<HalfCells> open(const std::filesystem::path& dataset);

  bool holds(CellIndex cell, int pass) const { return held_.contains({cell, pass}); }
  /// 0 when it is not there.
  int generation(CellIndex cell, int pass) const;
  std::size_t size() const { return held_.size(); }
  /// The cells of a pass.
  std::vector<CellIndex> cells(int pass) const;

  /// Durable when this returns. `half` has one pass and a dark set.
  Status add(const HalfCell& half);
  /// Errors: one that is not there, or was damaged since it was stored.
  Result<HalfCell> read(CellIndex cell, int pass);
  /// What is stale does not count any more; its files stay.
  void forget_stale(const Manifest& manifest);
  /// Removes what is stale, temporary files, dark sets that no half cell names, and the folder when it is empty. A file
  /// that could not be read, of a cell that is not whole, stays with all dark sets: it may be readable another time.
  Status remove_stale(const Manifest& manifest);

  /// What open() passed over.
  const std::vector<std::string>& notes() const { return notes_; }

 private:
  struct Held {
    int generation;
    std::string dark;  ///< its file's name
  };
  explicit HalfCells(std::filesystem::path folder) : folder_(std::move(folder)) {}
  Result<std::shared_ptr<const DarkSet>> read_dark(const std::string& name);
  Result<std::string> add_dark(const std::shared_ptr<const DarkSet>& dark);
  Status look_through();

  std::filesystem::path folder_;
  std::map<std::pair<CellIndex, int>, Held> held_;
  std::vector<std::string> notes_;
  /// The dark set read or written last, so that cells of one block share it.
  std::string dark_name_;
  std::shared_ptr<const DarkSet> dark_;
};

}  // namespace lumifield
