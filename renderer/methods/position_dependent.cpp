#include "renderer/methods/position_dependent.h"

#include <algorithm>
#include <cmath>

#include "renderer/methods/seen_pixels.h"

namespace lumifield {

void add_sample(const ReceiverView& view, const SampledCell& cell, const Vec2& tau, int i, int j, double scale,
                std::vector<double>& sum) {
  const double importance = cell.importance.value(i, j);
  if (!(importance > 0)) return;
  view.over_values(view.weights(cell.number, tau), of_pixel(cell, i, j),
                   [&](std::size_t k, double value) { sum[k] += scale / importance * value; });
}

PositionDependent::PositionDependent(const LightField& light_field, const MethodSettings& settings)
    : geometry_(light_field.geometry()),
      basis_(geometry_.sampling.basis),
      settings_(settings),
      lights_(light_field, settings) {}

Result<std::vector<double>> PositionDependent::light(const Receiver& receiver, std::uint32_t number,
                                                     const Look& look) const {
  const ReceiverView view(geometry_, basis_, receiver, look);
  std::vector<double> sum(view.values(), 0.0);
  if (!view.in_front()) return sum;
  const LightSamples::Balance share = lights_.balance(view, settings_.samples);
  const std::vector<int> counts = lights_.counts(share, number);
  const double support = 4 * view.half_support() * view.half_support();
  for (std::size_t m = 0; m < counts.size(); ++m) {
    if (counts[m] == 0) continue;
    const SampledCell& cell = lights_.cells()[m];
    const double scale = (share.on_u ? support : share.a[m]) / share.kappa[m];
    lights_.over_draws(view, number, cell, share.on_u, counts[m], [&](const Vec2& tau, int i, int j) {
      add_sample(view, cell, tau, i, j, share.on_u ? scale * cell.importance.value(i, j) : scale, sum);
    });
  }
  return sum;
}

/// The variance of a cell's sum is at most 1/κ ∫ (F C)²/q dτ for samples of density q, whatever the rounding of κ.
Result<Estimate> PositionDependent::estimate(const Receiver& receiver, std::uint32_t number, const Look& look) const {
  auto value = light(receiver, number, look);
  if (!value) return tl::unexpected(value.error());
  const ReceiverView view(geometry_, basis_, receiver, look);
  Estimate result{std::move(*value), std::vector<double>(view.values(), 0.0)};
  if (!view.in_front()) return result;
  const LightSamples::Balance share = lights_.balance(view, settings_.samples);
  const double support = 4 * view.half_support() * view.half_support();
  for (std::size_t m = 0; m < share.kappa.size(); ++m) {
    if (!(share.kappa[m] > 0)) continue;
    const SampledCell& cell = lights_.cells()[m];
    const auto scale = [&](int i, int j) {
      const double importance = cell.importance.value(i, j);
      if (!(importance > 0)) return 0.0;
      return (share.on_u ? support : share.a[m] / importance) / share.kappa[m];
    };
    add_variance(view, cell, scale, result.stated_error);
  }
  for (double& each : result.stated_error) each = std::sqrt(each);
  return result;
}

}  // namespace lumifield
