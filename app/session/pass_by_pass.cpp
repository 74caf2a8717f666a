#include "app/session/pass_by_pass.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace lumifield {

Result<PassByPass> PassByPass::open(const Bench& bench, const Plan& plan, const std::filesystem::path& dataset,
                                    const Manifest& whole) {
  Result<HalfCells> halves = HalfCells::open(dataset);
  if (!halves) return tl::unexpected(halves.error());
  halves->forget_stale(whole);
  PassByPass passes(bench, plan, std::move(*halves));
  for (const CellEntry& entry : whole.cells) passes.generations_[entry.cell] = entry.generation;
  return passes;
}

/// Its place among the bench's; the bench's number of passes for none of them.
int PassByPass::pass_of(const RawCell& raw) const {
  const std::vector<FilterPass>& all = bench_.filter.passes;
  return static_cast<int>(std::ranges::find(all, raw.passes.front().name, &FilterPass::name) - all.begin());
}

PassCells PassByPass::taken() const {
  PassCells taken;
  for (int pass = 0; pass < passes(); ++pass) {
    const std::vector<CellIndex> cells = halves_.cells(pass);
    taken.emplace_back(cells.begin(), cells.end());
  }
  return taken;
}

std::vector<std::string> PassByPass::notes() const {
  std::vector<std::string> notes = halves_.notes();
  for (int pass = 0; pass < passes(); ++pass)
    if (const std::size_t cells = halves_.cells(pass).size(); cells > 0)
      notes.push_back("of " + std::to_string(cells) + " cells the pass '" +
                      bench_.filter.passes[static_cast<std::size_t>(pass)].name + "' is there");
  return notes;
}

Status PassByPass::keep(const RawCell& raw) {
  const auto whole = generations_.find(raw.cell);
  const int generation = whole == generations_.end() ? 1 : whole->second + 1;
  Status kept = halves_.add({pass_of(raw), generation, raw});
  if (kept) kept_.insert(pass_of(raw));
  return kept;
}

Result<RawCell> PassByPass::half(CellIndex cell, int pass) {
  Result<HalfCell> half = halves_.read(cell, pass);
  if (!half) return tl::unexpected(half.error());
  half->raw.passes.front().name = bench_.filter.passes[static_cast<std::size_t>(pass)].name;
  return std::move(half->raw);
}

Result<RawCell> PassByPass::whole(RawCell last) {
  RawCell cell = std::move(last);
  std::vector<RawPass> earlier;
  for (int pass = 0; pass + 1 < passes(); ++pass) {
    Result<RawCell> kept = half(cell.cell, pass);
    if (!kept) return kept;
    RawPass& raw = earlier.emplace_back(std::move(kept->passes.front()));
    raw.dark = kept->dark;
    cell.position_error_mm = std::max(cell.position_error_mm, kept->position_error_mm);
    if (std::abs(kept->drift) > std::abs(cell.drift)) cell.drift = kept->drift;
    if (pass == 0) cell.reference_dn_per_s = kept->reference_dn_per_s;
  }
  cell.passes.insert(cell.passes.begin(), std::make_move_iterator(earlier.begin()),
                     std::make_move_iterator(earlier.end()));
  return cell;
}

Result<std::optional<CellImage>> PassByPass::alone(const RawCell& raw) {
  if (pass_of(raw) != 0 || generations_.contains(raw.cell)) return std::nullopt;
  if (!alone_) {
    Result<Developer> developer = Developer::create(with_pass(bench_, 0), plan_);
    if (!developer) return tl::unexpected(developer.error());
    alone_.emplace(std::move(*developer));
  }
  Result<CellImage> image = alone_->develop(raw);
  if (!image) return tl::unexpected(image.error());
  return std::optional(std::move(*image));
}

std::vector<CellIndex> PassByPass::to_show() const {
  std::vector<CellIndex> cells = passes() > 1 ? halves_.cells(0) : std::vector<CellIndex>{};
  std::erase_if(cells, [&](CellIndex cell) { return generations_.contains(cell); });
  return cells;
}

}  // namespace lumifield
