#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <vector>

#include "acquisition/scan/scan_plan.h"
#include "calibration/develop.h"
#include "luminaire/half_cells.h"

namespace lumifield {

/// The cells of a scan whose slide the operator changes (PassChange::by_operator), on their way from bench to develop:
/// each pass is kept durably until the last one makes the cell whole.
///
/// Half cells stay until the dataset is closed: until then a cell may be taken again in the pass that is in. A cell
/// that is whole and has a half cell of a later generation is one that is being taken again, and is gone on with.
/// Thread-bound to the develop thread while that runs.
class PassByPass {
 public:
  /// Of a dataset whose writer the caller holds, with these whole cells. Removes nothing.
  static Result<PassByPass> open(const Bench& bench, const Plan& plan, const std::filesystem::path& dataset,
                                 const Manifest& whole);

  /// Where a scan goes on: cells by pass.
  PassCells taken() const;
  bool is_last(const RawCell& raw) const { return pass_of(raw) + 1 == passes(); }
  /// The first cell of a pass since the start: what it refers to is to be made durable before.
  bool begins(const RawCell& raw) const { return !kept_.contains(pass_of(raw)); }
  /// Durable when this returns.
  Status keep(const RawCell& raw);
  /// The last pass joined by those that were kept: as a cell whose passes are taken together, each pass with its own
  /// dark set. Of the readings of the reference cell the first pass' counts, of drifts the largest.
  Result<RawCell> whole(RawCell last);
  /// What one pass alone makes, for a preview; nothing of any but the first, whose light is negative, and of a cell
  /// that was whole at the start, whose earlier generation counts.
  Result<std::optional<CellImage>> alone(const RawCell& raw);
  /// The first pass' half cells of cells that are not whole.
  std::vector<CellIndex> to_show() const;
  Result<RawCell> half(CellIndex cell, int pass);

  std::size_t size() const { return halves_.size(); }
  bool kept_any() const { return !kept_.empty(); }
  Status remove_stale(const Manifest& manifest) { return halves_.remove_stale(manifest); }
  /// For the operator: what is there, and what is damaged and counts as missing.
  std::vector<std::string> notes() const;

 private:
  PassByPass(const Bench& bench, const Plan& plan, HalfCells halves)
      : bench_(bench), plan_(plan), halves_(std::move(halves)) {}
  int passes() const { return static_cast<int>(bench_.filter.passes.size()); }
  int pass_of(const RawCell& raw) const;

  Bench bench_;
  Plan plan_;
  HalfCells halves_;
  std::map<CellIndex, int> generations_;  ///< of the cells that were whole at the start
  std::set<int> kept_;                    ///< passes
  std::optional<Developer> alone_;
};

}  // namespace lumifield
