#include "app/session/preview_detail.h"

#include <algorithm>

namespace lumifield {

namespace {

constexpr std::array divisors{1, 2, 3, 4, 5, 6, 8, 10, 12, 16};
/// 1.4 % off on a sharp beam.
constexpr double coarse_lod = 8;

/// Of the time there is.
constexpr double fits_well = 0.75, nearly_fits = 1.2;

/// Seconds that cells may be waited for, and as many as are added one by one all the same.
constexpr double long_backlog_s = 0.4;
constexpr int few_cells = 3;

}  // namespace

void PreviewCosts::drawn(PreviewDetail detail, double receivers, double seconds) {
  of(detail).draw.learn(receivers, seconds);
}

void PreviewCosts::summed(PreviewDetail detail, double receivers, int cells, double seconds) {
  if (cells < 1) return;
  of(detail).cell.learn(receivers, seconds / cells);
  of(detail).learned = true;
}

void PreviewCosts::shown(PreviewDetail detail, double receivers, double seconds) {
  of(detail).show.learn(receivers, seconds);
}

double PreviewCosts::picture_s(PreviewDetail detail, double receivers, int cells) const {
  const Costs& costs = expected(detail);
  return costs.draw.seconds(receivers) + cells * costs.cell.seconds(receivers) + costs.show.seconds(receivers);
}

double PreviewCosts::cell_s(PreviewDetail detail, double receivers) const {
  return expected(detail).cell.seconds(receivers);
}

PreviewDetail PreviewCosts::finest_within(double seconds, double full_receivers, int cells,
                                          PreviewDetail before) const {
  if (picture_s({}, full_receivers, cells) <= seconds) return {};
  const auto fits = [&](int divisor) {
    const double takes_s = picture_s({divisor, coarse_lod}, full_receivers / (divisor * divisor), cells);
    if (before.full() || divisor > before.divisor) return takes_s <= seconds;
    return takes_s <= seconds * (divisor == before.divisor ? nearly_fits : fits_well);
  };
  const auto finest = std::ranges::find_if(divisors, fits);
  return {finest == divisors.end() ? divisors.back() : *finest, coarse_lod};
}

bool shows_coarsely_first(int waiting, int cells, double cell_s) {
  return waiting > few_cells && 2 * waiting >= cells && waiting * cell_s > long_backlog_s;
}

bool shows_all_coarsely_first(int fresh, int cells, double cell_s) {
  return 2 * fresh >= cells && cells * cell_s > long_backlog_s;
}

PreviewDetail coarsest() { return {divisors.back(), coarse_lod}; }

}  // namespace lumifield
