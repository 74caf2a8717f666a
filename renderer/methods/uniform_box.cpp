#include "renderer/methods/uniform_box.h"

#include <cmath>

#include "renderer/methods/position_dependent.h"
#include "renderer/methods/receiver_view.h"
#include "renderer/methods/seen_pixels.h"
#include "renderer/sampling/sample_counts.h"

namespace lumifield {

UniformBox::UniformBox(const LightField& light_field, const MethodSettings& settings)
    : geometry_(light_field.geometry()),
      basis_(geometry_.sampling.basis),
      settings_(settings),
      cells_(measured_cells(light_field)),
      points_(settings.sequence, settings.samples, settings.seed) {}

Result<std::vector<double>> UniformBox::light(const Receiver& receiver, std::uint32_t number, const Look& look) const {
  const ReceiverView view(geometry_, basis_, receiver, look);
  std::vector<double> sum(view.values(), 0.0);
  if (!view.in_front() || cells_.empty()) return sum;
  const double kappa = settings_.samples / static_cast<double>(cells_.size()), half = view.half_support();
  const std::vector<int> counts =
      systematic_rounding(std::vector<double>(cells_.size(), kappa), rounding_offset(settings_.seed, number));
  for (std::size_t m = 0; m < cells_.size(); ++m) {
    const MeasuredCell& cell = cells_[m];
    for (int k = 0; k < counts[m]; ++k) {
      const UnitPoint xi = points_.at(cell.number, number, k);
      const Vec2 tau(half * (2.0 * xi.x - 1), half * (2.0 * xi.y - 1));
      int i = 0, j = 0;
      if (!pixel_under(view, cell.u_mm, tau, i, j)) continue;
      view.over_values(view.weights(cell.number, tau), of_pixel(cell, i, j),
                       [&](std::size_t c, double value) { sum[c] += 4 * half * half / kappa * value; });
    }
  }
  return sum;
}

Result<Estimate> UniformBox::estimate(const Receiver& receiver, std::uint32_t number, const Look& look) const {
  auto value = light(receiver, number, look);
  if (!value) return tl::unexpected(value.error());
  const ReceiverView view(geometry_, basis_, receiver, look);
  Estimate result{std::move(*value), std::vector<double>(view.values(), 0.0)};
  if (!view.in_front() || cells_.empty()) return result;
  const double kappa = settings_.samples / static_cast<double>(cells_.size()), half = view.half_support();
  for (const MeasuredCell& cell : cells_)
    add_variance(
        view, cell, [&](int, int) { return 4 * half * half / kappa; }, result.stated_error);
  for (double& each : result.stated_error) each = std::sqrt(each);
  return result;
}

}  // namespace lumifield
