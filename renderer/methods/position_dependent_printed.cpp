#include "renderer/methods/position_dependent_printed.h"

#include <cmath>

#include "renderer/methods/position_dependent.h"
#include "renderer/methods/seen_pixels.h"
#include "renderer/sampling/sample_counts.h"

namespace lumifield {

namespace {

constexpr const char* use_corrected = "use position-dependent";

}  // namespace

Status check_printed_luminaire(const LightField& light_field) {
  const Sampling& sampling = light_field.geometry().sampling;
  for (int flat = 0; flat < sampling.cells(); ++flat) {
    const auto image = light_field.cell(sampling.index(flat));
    if (!image) continue;
    const std::vector<double> luminance = luminance_image(*image);
    for (std::size_t k = 0; k < luminance.size(); ++k)
      if (luminance[k] < 0) {
        const auto width = static_cast<std::size_t>(image->width_px);
        return fail("the luminance is below 0, which the published method cannot sample",
                    "cell " + to_string(sampling.index(flat)) + ", pixel (" + std::to_string(k % width) + ", " +
                        std::to_string(k / width) + ")",
                    use_corrected);
      }
  }
  return {};
}

Result<std::unique_ptr<PositionDependentPrinted>> PositionDependentPrinted::create(const LightField& light_field,
                                                                                   const MethodSettings& settings) {
  if (const Status good = check_printed_luminaire(light_field); !good) return tl::unexpected(good.error());
  return std::unique_ptr<PositionDependentPrinted>(new PositionDependentPrinted(light_field, settings));
}

PositionDependentPrinted::PositionDependentPrinted(const LightField& light_field, const MethodSettings& settings)
    : geometry_(light_field.geometry()),
      basis_(geometry_.sampling.basis),
      settings_(settings),
      cells_(sampled_cells(light_field, luminance_image)),
      points_(settings.sequence, settings.samples, settings.seed) {
  for (const SampledCell& cell : cells_) tables_.emplace_back(cell.importance);
}

Status check_printed_receiver(const LuminaireGeometry& geometry, const Receiver& receiver) {
  const Basis basis(geometry.sampling.basis);
  const ReceiverView view(geometry, basis, receiver);
  if (view.delta_mm() < 0)
    return fail("lies between the planes, where the published equations do not hold", "receiver", use_corrected);
  if (view.delta_mm() > 0 && view.span_px() < printed_least_span_px)
    return fail("lies so near S that the published box has no digits", "receiver", use_corrected);
  return {};
}

std::vector<double> PositionDependentPrinted::areas(const ReceiverView& view) const {
  std::vector<double> a;
  for (const SampledCell& cell : cells_) {
    if (view.delta_mm() > 0) {
      const PixelBox box = cell.importance.clipped(view.box(cell.u_mm));
      a.push_back(cell.importance.integral(box) / std::abs(view.rate().prod()));
      continue;
    }
    int i = 0, j = 0;
    a.push_back(pixel_under(view, cell.u_mm, {0, 0}, i, j) ? cell.importance.value(i, j) : 0);
  }
  return a;
}

Result<std::vector<double>> PositionDependentPrinted::light(const Receiver& receiver, std::uint32_t number,
                                                            const Look& look) const {
  const ReceiverView view(geometry_, basis_, receiver, look);
  std::vector<double> sum(view.values(), 0.0);
  if (!view.in_front()) return sum;
  if (const Status good = check_printed_receiver(geometry_, receiver); !good) return tl::unexpected(good.error());
  const std::vector<double> a = areas(view);
  const std::vector<int> counts = nearest_counts(expected_counts(a, settings_.samples, settings_.k_max));
  const double half = view.half_support();
  for (std::size_t m = 0; m < cells_.size(); ++m) {
    const SampledCell& cell = cells_[m];
    const PixelBox box = cell.importance.clipped(view.box(cell.u_mm));
    for (int k = 0; k < counts[m]; ++k) {
      const UnitPoint xi = points_.at(0, number, k);
      int i = 0, j = 0;
      Vec2 tau(half * (2.0 * xi.x - 1), half * (2.0 * xi.y - 1));
      double scale = 4 * half * half / counts[m];
      if (view.delta_mm() > 0) {
        const auto point = tables_[m].sample(xi.x, xi.y, box, settings_.inversion, settings_.depth);
        if (!point) continue;
        tau = view.tau(cell.u_mm, {point->x, point->y});
        i = point->i, j = point->j;
        scale = a[m] / counts[m];
      } else if (!pixel_under(view, cell.u_mm, tau, i, j)) {
        continue;
      } else {
        scale *= cell.importance.value(i, j);
      }
      add_sample(view, cell, tau, i, j, scale, sum);
    }
  }
  return sum;
}

Result<Estimate> PositionDependentPrinted::estimate(const Receiver& receiver, std::uint32_t number,
                                                    const Look& look) const {
  auto value = light(receiver, number, look);
  if (!value) return tl::unexpected(value.error());
  const ReceiverView view(geometry_, basis_, receiver, look);
  Estimate result{std::move(*value), std::vector<double>(view.values(), 0.0)};
  if (!view.in_front()) return result;
  const std::vector<double> a = areas(view);
  const std::vector<int> counts = nearest_counts(expected_counts(a, settings_.samples, settings_.k_max));
  const double support = 4 * view.half_support() * view.half_support(), rates = std::abs(view.rate().prod());
  std::vector<double> bias(view.values(), 0.0);
  for (std::size_t m = 0; m < cells_.size(); ++m) {
    const SampledCell& cell = cells_[m];
    const PixelBox box = cell.importance.clipped(view.box(cell.u_mm));
    over_seen_pixels(view, cell.u_mm, [&](int i, int j, const Vec2& tau, double area) {
      // `wanted` is the density that the estimator divides by, `drawn` that of its samples.
      const double luminance = cell.importance.value(i, j);
      if (!(luminance > 0)) return;
      const Vec2 at = view.on_s_px(cell.u_mm, tau);
      const bool on_s = !(view.delta_mm() > 0);
      const double wanted = on_s ? 1 / support : a[m] > 0 ? luminance / a[m] : 0;
      const double drawn = on_s ? 1 / support : rates * tables_[m].pdf(at.x(), at.y(), box);
      const double ratio = counts[m] > 0 && wanted > 0 ? drawn / wanted : 0;
      view.over_values(view.weights(cell.number, tau), of_pixel(cell, i, j), [&](std::size_t c, double f) {
        bias[c] += area * f * (ratio - 1);
        if (counts[m] > 0 && wanted > 0) result.stated_error[c] += area * f * f * drawn / (wanted * wanted) / counts[m];
      });
    });
  }
  for (std::size_t c = 0; c < bias.size(); ++c)
    result.stated_error[c] = std::abs(bias[c]) + std::sqrt(result.stated_error[c]);
  return result;
}

}  // namespace lumifield
