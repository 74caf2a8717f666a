#include "app/session/preview_detail.h"

#include <algorithm>

namespace lumifield {

namespace {

constexpr std::array divisors{1, 2, 3, 4, 6, 8, 12, 16};
constexpr double coarse_lod = 4;

/// Seconds that cells may be waited for, and as many as are added one by one all the same.
constexpr double long_backlog_s = 0.4;
constexpr int few_cells = 3;

/// Half the old, half the new: a lone disturbance does not count for long.
void learn(double& rate, double seconds, double amount) {
  if (amount > 0) rate = (rate + seconds / amount) / 2;
}

}  // namespace

void PreviewCosts::drawn(PreviewDetail detail, double pixels, double seconds) {
  learn(rates_[detail.full() ? 1 : 0].draw, seconds, pixels);
}

void PreviewCosts::summed(PreviewDetail detail, double pixels, int cells, double seconds) {
  learn(rates_[detail.full() ? 1 : 0].sum, seconds, pixels * cells);
}

void PreviewCosts::shown(PreviewDetail detail, double pixels, double seconds) {
  learn(rates_[detail.full() ? 1 : 0].show, seconds, pixels);
}

double PreviewCosts::picture_s(PreviewDetail detail, double pixels, int cells) const {
  const Rates& rates = of(detail);
  return pixels * (rates.draw + rates.show + cells * rates.sum);
}

double PreviewCosts::cell_s(PreviewDetail detail, double pixels) const { return pixels * of(detail).sum; }

PreviewDetail PreviewCosts::finest_within(double seconds, double full_pixels, int cells, PreviewDetail before) const {
  if (picture_s({}, full_pixels, cells) <= seconds) return {};
  const auto takes = [&](int divisor) {
    return picture_s({divisor, coarse_lod}, full_pixels / (divisor * divisor), cells);
  };
  if (!before.full() && takes(before.divisor) <= 1.2 * seconds && takes(before.divisor) >= 0.4 * seconds) return before;
  const auto fits = std::ranges::find_if(divisors, [&](int divisor) { return takes(divisor) <= seconds; });
  return {fits == divisors.end() ? divisors.back() : *fits, coarse_lod};
}

bool shows_coarsely_first(int waiting, int cells, double cell_s) {
  return waiting > few_cells && 2 * waiting >= cells && waiting * cell_s > long_backlog_s;
}

}  // namespace lumifield
