#include "renderer/methods/light_samples.h"

#include <algorithm>
#include <cmath>

#include "renderer/methods/method.h"
#include "renderer/sampling/sample_counts.h"

namespace lumifield {

LightSamples::LightSamples(const LightField& light_field, const MethodSettings& settings)
    : cells_(sampled_cells(light_field)),
      points_(settings.sequence, settings.samples, settings.seed),
      seed_(settings.seed),
      k_max_(settings.k_max),
      inversion_(settings.inversion),
      depth_(settings.depth) {}

double mean_importance(const ReceiverView& view, const SampledCell& cell) {
  const Vec2 center = view.on_s_px(cell.u_mm, {0, 0}), reach = view.half_support() * view.rate().cwiseAbs();
  const Vec2 first = (center - reach).array().floor(), last = (center + reach).array().floor();
  double sum = 0;
  for (double j = std::max(first.y(), 0.0); j <= std::min(last.y(), cell.importance.height_px() - 1.0); ++j)
    for (double i = std::max(first.x(), 0.0); i <= std::min(last.x(), cell.importance.width_px() - 1.0); ++i)
      sum += cell.importance.value(static_cast<int>(i), static_cast<int>(j));
  return sum / ((last.x() - first.x() + 1) * (last.y() - first.y() + 1));
}

bool pixel_under(const ReceiverView& view, const Vec2& u_m, const Vec2& tau, int& i, int& j) {
  const Measurement& m = view.geometry().measurement;
  const Vec2 on_s = view.on_s_px(u_m, tau);
  if (!(on_s.x() >= 0 && on_s.x() < m.width_px && on_s.y() >= 0 && on_s.y() < m.height_px)) return false;
  i = static_cast<int>(on_s.x());
  j = static_cast<int>(on_s.y());
  return true;
}

LightSamples::Balance LightSamples::balance(const ReceiverView& view, double k) const {
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
  balance.kappa = expected_counts(balance.a, k, k_max_);
  return balance;
}

std::vector<int> LightSamples::counts(const Balance& balance, std::uint32_t number) const {
  return systematic_rounding(balance.kappa, rounding_offset(seed_, number));
}

}  // namespace lumifield
