#include "renderer/methods/precomputed_lights.h"

#include <cmath>
#include <numeric>

#include "renderer/methods/receiver_view.h"
#include "renderer/methods/seen_pixels.h"
#include "renderer/sampling/piecewise_constant_2d.h"
#include "renderer/sampling/sample_counts.h"

namespace lumifield {

namespace {

/// T_m, row by row.
double importance_of(const CellImage& image) {
  double total = 0;
  for (int j = 0; j < image.height_px; ++j) {
    double row = 0;
    for (int i = 0; i < image.width_px; ++i) row += importance_at(image, i, j);
    total += row;
  }
  return total;
}

std::vector<double> importances_of(std::span<const MeasuredCell> cells) {
  std::vector<double> totals;
  for (const MeasuredCell& cell : cells) totals.push_back(importance_of(*cell.image));
  return totals;
}

double sum_of(const std::vector<double>& values) { return std::accumulate(values.begin(), values.end(), 0.0); }

}  // namespace

std::vector<PrecomputedLight> precompute_lights(std::span<const MeasuredCell> cells, const MethodSettings& settings) {
  const std::vector<double> totals = importances_of(cells);
  const std::vector<int> counts =
      systematic_rounding(expected_counts(totals, settings.samples), rounding_offset(settings.seed, 0));
  const double share = sum_of(totals) / settings.samples;
  const PointSet points(settings.sequence, settings.samples, settings.seed);
  std::vector<PrecomputedLight> lights;
  for (std::size_t m = 0; m < cells.size(); ++m) {
    if (counts[m] == 0) continue;
    const MeasuredCell& cell = cells[m];
    const PiecewiseConstant2D table(summed_area_table(cell, importance_image));
    for (int k = 0; k < counts[m]; ++k) {
      const UnitPoint xi = points.at(cell.number, 0, k);
      const auto point = table.sample(xi.x, xi.y, table.whole());
      const double importance = point ? importance_at(*cell.image, point->i, point->j) : 0;
      if (!(importance > 0)) continue;
      PrecomputedLight light{static_cast<int>(m), {point->x, point->y}, {}};
      for (int c = 0; c < cell.image->channels; ++c)
        light.value[static_cast<std::size_t>(c)] = share * cell.image->at(c, point->i, point->j) / importance;
      lights.push_back(light);
    }
  }
  return lights;
}

PrecomputedLights::PrecomputedLights(const LightField& light_field, const MethodSettings& settings)
    : geometry_(light_field.geometry()),
      basis_(geometry_.sampling.basis),
      settings_(settings),
      cells_(measured_cells(light_field)),
      total_(sum_of(importances_of(cells_))),
      lights_(precompute_lights(cells_, settings)) {}

Result<std::vector<double>> PrecomputedLights::light(const Receiver& receiver, std::uint32_t, const Look& look) const {
  const ReceiverView view(geometry_, basis_, receiver, look);
  std::vector<double> sum(view.values(), 0.0);
  if (!view.in_front()) return sum;
  const double rates = std::abs(view.rate().prod());
  if (!(rates > 0)) return fail("lies on S, where no light is seen", "receiver", "use closed-form");
  for (const PrecomputedLight& light : lights_) {
    const MeasuredCell& cell = cells_[static_cast<std::size_t>(light.cell)];
    view.over_values(
        view.weights(cell.number, view.tau(cell.u_mm, light.on_s_px)), [&](std::size_t c) { return light.value[c]; },
        [&](std::size_t k, double value) { sum[k] += value / rates; });
  }
  return sum;
}

Result<Estimate> PrecomputedLights::estimate(const Receiver& receiver, std::uint32_t number, const Look& look) const {
  auto value = light(receiver, number, look);
  if (!value) return tl::unexpected(value.error());
  const ReceiverView view(geometry_, basis_, receiver, look);
  Estimate result{std::move(*value), std::vector<double>(view.values(), 0.0)};
  if (!view.in_front() || lights_.empty()) return result;
  const double share = total_ / settings_.samples / std::abs(view.rate().prod());
  for (const MeasuredCell& cell : cells_) {
    const auto scale = [&](int i, int j) {
      const double importance = importance_at(*cell.image, i, j);
      return importance > 0 ? share / importance : 0;
    };
    add_variance(view, cell, scale, result.stated_error);
  }
  for (double& each : result.stated_error) each = std::sqrt(each);
  return result;
}

}  // namespace lumifield
