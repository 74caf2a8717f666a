#include "renderer/methods/position_dependent.h"

#include <algorithm>
#include <cmath>

#include "renderer/methods/seen_pixels.h"
#include "renderer/sampling/box_distribution.h"
#include "renderer/sampling/sample_counts.h"

namespace lumifield {

void add_sample(const ReceiverView& view, const SampledCell& cell, const Vec2& tau, int i, int j, double scale,
                std::vector<double>& sum) {
  const double importance = cell.importance.value(i, j);
  if (!(importance > 0)) return;
  view.over_values(view.weights(cell.number, tau), of_pixel(cell, i, j),
                   [&](std::size_t k, double value) { sum[k] += scale / importance * value; });
}

bool pixel_under(const ReceiverView& view, const Vec2& u_m, const Vec2& tau, int& i, int& j) {
  const Measurement& m = view.geometry().measurement;
  const Vec2 on_s = view.on_s_px(u_m, tau);
  if (!(on_s.x() >= 0 && on_s.x() < m.width_px && on_s.y() >= 0 && on_s.y() < m.height_px)) return false;
  i = static_cast<int>(on_s.x());
  j = static_cast<int>(on_s.y());
  return true;
}

PositionDependent::PositionDependent(const LightField& light_field, const MethodSettings& settings)
    : geometry_(light_field.geometry()),
      basis_(geometry_.sampling.basis),
      settings_(settings),
      cells_(sampled_cells(light_field)),
      points_(settings.sequence, settings.samples, settings.seed) {}

namespace {

/// Over the pixels that a support near S touches.
double mean_importance(const ReceiverView& view, const SampledCell& cell) {
  const Vec2 center = view.on_s_px(cell.u_mm, {0, 0}), reach = view.half_support() * view.rate().cwiseAbs();
  const Vec2 first = (center - reach).array().floor(), last = (center + reach).array().floor();
  double sum = 0;
  for (double j = std::max(first.y(), 0.0); j <= std::min(last.y(), cell.importance.height_px() - 1.0); ++j)
    for (double i = std::max(first.x(), 0.0); i <= std::min(last.x(), cell.importance.width_px() - 1.0); ++i)
      sum += cell.importance.value(static_cast<int>(i), static_cast<int>(j));
  return sum / ((last.x() - first.x() + 1) * (last.y() - first.y() + 1));
}

}  // namespace

PositionDependent::Balance PositionDependent::balance(const ReceiverView& view) const {
  Balance balance{{}, {}, view.span_px() < least_span_px};
  const double support = 4 * view.half_support() * view.half_support();
  for (const SampledCell& cell : cells_) {
    double a = 0;
    if (balance.on_u)
      a = support * mean_importance(view, cell);
    else
      a = BoxDistribution(cell.importance, view.box(cell.u_mm)).integral() / std::abs(view.rate().prod());
    balance.a.push_back(a);
  }
  balance.kappa = expected_counts(balance.a, settings_.samples, settings_.k_max);
  return balance;
}

/// `scale` is A_m/κ_m.
void PositionDependent::draw(const ReceiverView& view, std::uint32_t number, const SampledCell& cell, bool on_u,
                             double scale, int count, std::vector<double>& sum) const {
  const double half = view.half_support();
  const BoxDistribution box(cell.importance, view.box(cell.u_mm));
  for (int k = 0; k < count; ++k) {
    const UnitPoint xi = points_.at(cell.number, number, k);
    if (!on_u) {
      const auto point = box.sample(xi.x, xi.y, settings_.inversion, settings_.depth);
      if (point) add_sample(view, cell, view.tau(cell.u_mm, {point->x, point->y}), point->i, point->j, scale, sum);
      continue;
    }
    int i = 0, j = 0;
    const Vec2 tau(half * (2.0 * xi.x - 1), half * (2.0 * xi.y - 1));
    if (!pixel_under(view, cell.u_mm, tau, i, j)) continue;
    add_sample(view, cell, tau, i, j, scale * cell.importance.value(i, j), sum);
  }
}

Result<std::vector<double>> PositionDependent::light(const Receiver& receiver, std::uint32_t number,
                                                     const Look& look) const {
  const ReceiverView view(geometry_, basis_, receiver, look);
  std::vector<double> sum(view.values(), 0.0);
  if (!view.in_front()) return sum;
  const Balance share = balance(view);
  const std::vector<int> counts = systematic_rounding(share.kappa, rounding_offset(settings_.seed, number));
  const double support = 4 * view.half_support() * view.half_support();
  for (std::size_t m = 0; m < cells_.size(); ++m)
    if (counts[m] > 0)
      draw(view, number, cells_[m], share.on_u, (share.on_u ? support : share.a[m]) / share.kappa[m], counts[m], sum);
  return sum;
}

/// The variance of a cell's sum is at most 1/κ ∫ (F C)²/q dτ for samples of density q, whatever the rounding of κ.
Result<Estimate> PositionDependent::estimate(const Receiver& receiver, std::uint32_t number, const Look& look) const {
  auto value = light(receiver, number, look);
  if (!value) return tl::unexpected(value.error());
  const ReceiverView view(geometry_, basis_, receiver, look);
  Estimate result{std::move(*value), std::vector<double>(view.values(), 0.0)};
  if (!view.in_front()) return result;
  const Balance share = balance(view);
  const double support = 4 * view.half_support() * view.half_support();
  for (std::size_t m = 0; m < cells_.size(); ++m) {
    if (!(share.kappa[m] > 0)) continue;
    const SampledCell& cell = cells_[m];
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
