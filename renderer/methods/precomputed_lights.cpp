#include "renderer/methods/precomputed_lights.h"

#include <cmath>
#include <numeric>

#include "renderer/methods/receiver_view.h"
#include "renderer/methods/seen_pixels.h"
#include "renderer/sampling/piecewise_constant_2d.h"
#include "renderer/sampling/sample_counts.h"

namespace lumifield {

namespace {

double total_importance(const std::vector<SampledCell>& cells) {
  return std::accumulate(cells.begin(), cells.end(), 0.0,
                         [](double sum, const SampledCell& cell) { return sum + cell.importance.total(); });
}

}  // namespace

std::vector<PrecomputedLight> precompute_lights(const std::vector<SampledCell>& cells, const MethodSettings& settings) {
  std::vector<double> totals;
  for (const SampledCell& cell : cells) totals.push_back(cell.importance.total());
  const std::vector<int> counts =
      systematic_rounding(expected_counts(totals, settings.samples), rounding_offset(settings.seed, 0));
  const double share = total_importance(cells) / settings.samples;
  const PointSet points(settings.sequence, settings.samples, settings.seed);
  std::vector<PrecomputedLight> lights;
  for (std::size_t m = 0; m < cells.size(); ++m) {
    if (counts[m] == 0) continue;
    const SampledCell& cell = cells[m];
    const PiecewiseConstant2D table(cell.importance);
    for (int k = 0; k < counts[m]; ++k) {
      const UnitPoint xi = points.at(cell.number, 0, k);
      const auto point = table.sample(xi.x, xi.y, table.whole());
      if (!point || !(cell.importance.value(point->i, point->j) > 0)) continue;
      PrecomputedLight light{static_cast<int>(m), {point->x, point->y}, {}};
      for (int c = 0; c < cell.image->channels; ++c)
        light.value.push_back(share * cell.image->at(c, point->i, point->j) /
                              cell.importance.value(point->i, point->j));
      lights.push_back(std::move(light));
    }
  }
  return lights;
}

PrecomputedLights::PrecomputedLights(const LightField& light_field, const MethodSettings& settings)
    : geometry_(light_field.geometry()),
      basis_(geometry_.sampling.basis),
      settings_(settings),
      cells_(sampled_cells(light_field)),
      lights_(precompute_lights(cells_, settings)) {}

Result<std::vector<double>> PrecomputedLights::irradiance(const Receiver& receiver, std::uint32_t) const {
  std::vector<double> sum(geometry_.channels.size(), 0.0);
  const ReceiverView view(geometry_, basis_, receiver);
  if (!view.in_front() || lights_.empty()) return sum;
  const double rates = std::abs(view.rate().prod());
  if (!(rates > 0)) return fail("lies on S, where no light is seen", "receiver", "use closed-form");
  for (const PrecomputedLight& light : lights_) {
    const Vec2& u_m = cells_[static_cast<std::size_t>(light.cell)].u_mm;
    const double weight = view.weight(u_m, view.tau(u_m, light.on_s_px)) / rates;
    for (std::size_t c = 0; c < sum.size(); ++c) sum[c] += weight * light.value[c];
  }
  return sum;
}

Result<Estimate> PrecomputedLights::estimate(const Receiver& receiver, std::uint32_t number) const {
  auto value = irradiance(receiver, number);
  if (!value) return tl::unexpected(value.error());
  Estimate result{std::move(*value), std::vector<double>(geometry_.channels.size(), 0.0)};
  const ReceiverView view(geometry_, basis_, receiver);
  if (!view.in_front() || lights_.empty()) return result;
  const double share = total_importance(cells_) / settings_.samples / std::abs(view.rate().prod());
  for (const SampledCell& cell : cells_)
    over_seen_pixels(view, cell.u_mm, [&](int i, int j, const Vec2& tau, double area) {
      const double importance = cell.importance.value(i, j), weight = view.weight(cell.u_mm, tau);
      if (!(importance > 0)) return;
      for (std::size_t c = 0; c < result.stated_error.size(); ++c) {
        const double f = weight * cell.image->at(static_cast<int>(c), i, j);
        result.stated_error[c] += area * f * f / importance * share;
      }
    });
  for (double& each : result.stated_error) each = std::sqrt(each);
  return result;
}

}  // namespace lumifield
