#include "renderer/shift_invariant/shift_invariant.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "renderer/methods/gloss.h"
#include "renderer/methods/horizon.h"
#include "renderer/methods/receiver_view.h"

namespace lumifield {

namespace {

/// ∫ |τ| φ over a pixel's part of the support.
double absolute_w1(const Basis& basis, const AxisWeights::Pixel& pixel) {
  if (!(pixel.low < 0 && pixel.high > 0)) return std::abs(pixel.w1);
  return basis.moment(1, 0, pixel.high) - basis.moment(1, pixel.low, 0);
}

/// The lobe of a receiver towards a point of U.
std::array<double, 3> lobe_towards(const GlossLobe& lobe, const Receiver& at, const Vec2& u_mm) {
  return glossy_brdf(lobe, at.n, (Vec3(u_mm.x(), u_mm.y(), 0) - at.p_mm).normalized());
}

/// Sums over the pixels that a support shows, by channel.
struct SupportSums {
  double w00 = 0;         ///< C W0 W0
  double terms = 0;       ///< C (n_x a_x W1 W0 + n_y a_y W0 W1)
  double most_w00 = 0;    ///< the same of |C|
  double most_terms = 0;  ///< of |C|, |n| and ∫|τ|φ
};

}  // namespace

struct ShiftInvariant::View {
  View(const LuminaireGeometry& geometry, const Basis& basis, const Receiver& given)
      : at(at_lit_height(given)), seen(geometry, basis, given) {
    const double delta = geometry.planes.separation_mm, z = at.p_mm.z();
    factor = delta * delta * geometry.sampling.spacing_mm.prod() / (z * z * z);
    slope = geometry.sampling.spacing_mm.cwiseProduct(at.n.head<2>());
  }
  Receiver at;
  ReceiverView seen;
  double factor;  ///< δ² A/(δ+Δ)³
  Vec2 slope;     ///< (n_x a_x, n_y a_y)

  double facing(const Vec2& u_mm) const {
    return at.n.x() * (u_mm.x() - at.p_mm.x()) + at.n.y() * (u_mm.y() - at.p_mm.y()) - at.n.z() * at.p_mm.z();
  }
};

ShiftInvariant::ShiftInvariant(const LightField& light_field, const SpotSettings& settings)
    : geometry_(light_field.geometry()), basis_(light_field.geometry().sampling.basis), settings_(settings) {
  const Sampling& sampling = geometry_.sampling;
  for (int flat = 0; flat < sampling.cells(); ++flat) {
    const CellIndex index = sampling.index(flat);
    auto image = light_field.cell(index);
    if (!image) continue;
    std::unique_ptr<SpotImage> levels;
    if (settings.look_up == SpotLookUp::textured) levels = std::make_unique<SpotImage>(*image);
    cells_.push_back({index, sampling.cell_center_mm(index), std::move(image), std::move(levels)});
  }
}

/// The pixels of both axes that a cell's support shows.
std::pair<AxisWeights, AxisWeights> ShiftInvariant::axes(const View& view, const Cell& cell) const {
  const Measurement& m = geometry_.measurement;
  const Vec2 a = geometry_.sampling.spacing_mm, corner = m.corner_mm();
  const Vec3& p = view.at.p_mm;
  const double delta = geometry_.planes.separation_mm;
  return {axis_weights(basis_, {delta, p.z(), p.x()}, {cell.u_mm.x(), a.x(), corner.x(), m.pixel_mm.x(), m.width_px}),
          axis_weights(basis_, {delta, p.z(), p.y()}, {cell.u_mm.y(), a.y(), corner.y(), m.pixel_mm.y(), m.height_px})};
}

std::vector<double> ShiftInvariant::averages(const View& view, const Cell& cell) const {
  std::vector<double> sums(geometry_.channels.size(), 0.0);
  if (cell.levels) {
    const double level =
        spot_level(basis_, view.seen.rate(), coarsest_level(cell.image->width_px, cell.image->height_px));
    const Vec2 at = view.seen.on_s_px(cell.u_mm, {0, 0});
    for (std::size_t c = 0; c < sums.size(); ++c) sums[c] = cell.levels->look_up(static_cast<int>(c), at, level);
    return sums;
  }
  const auto [x, y] = axes(view, cell);
  for (std::size_t c = 0; c < sums.size(); ++c)
    for (std::size_t j = 0; j < y.pixels.size(); ++j) {
      double row = 0;
      for (std::size_t i = 0; i < x.pixels.size(); ++i)
        row += x.pixels[i].w0 * cell.image->at(static_cast<int>(c), x.first + int(i), y.first + int(j));
      sums[c] += y.pixels[j].w0 * row;
    }
  return sums;
}

ShiftInvariant::Spot ShiftInvariant::spot(const View& view, const Cell& cell) const {
  const std::size_t channels = geometry_.channels.size();
  const double half = basis_.half_support();
  const HorizonPlane g{view.facing(cell.u_mm), view.slope.x(), view.slope.y()};
  const BasisRectangle support{-half, half, -half, half};
  Spot spot{std::vector<double>(channels, 0.0), std::vector<double>(channels, 0.0), std::vector<double>(channels, 0.0)};
  if (highest(g, support) <= 0) return spot;
  const bool above = lowest(g, support) >= 0;
  const std::vector<double> average = averages(view, cell);
  const double facing = std::max(g.k, 0.0);
  const auto [x, y] = axes(view, cell);
  std::vector<double> x_most, y_most;
  for (const AxisWeights::Pixel& pixel : x.pixels) x_most.push_back(absolute_w1(basis_, pixel));
  for (const AxisWeights::Pixel& pixel : y.pixels) y_most.push_back(absolute_w1(basis_, pixel));
  for (std::size_t c = 0; c < channels; ++c) {
    SupportSums sums;
    for (std::size_t j = 0; j < y.pixels.size(); ++j)
      for (std::size_t i = 0; i < x.pixels.size(); ++i) {
        const double value = cell.image->at(static_cast<int>(c), x.first + int(i), y.first + int(j));
        const AxisWeights::Pixel &px = x.pixels[i], &py = y.pixels[j];
        sums.w00 += value * px.w0 * py.w0;
        sums.terms += value * (g.x * px.w1 * py.w0 + g.y * px.w0 * py.w1);
        sums.most_w00 += std::abs(value) * px.w0 * py.w0;
        sums.most_terms += std::abs(value) * (std::abs(g.x) * x_most[i] * py.w0 + std::abs(g.y) * px.w0 * y_most[j]);
      }
    spot.light[c] = view.factor * facing * average[c];
    spot.off[c] =
        view.factor * ((above ? std::abs(sums.terms) : sums.most_terms) + facing * std::abs(average[c] - sums.w00));
    spot.most[c] = view.factor * (facing * sums.most_w00 + sums.most_terms);
  }
  return spot;
}

double ShiftInvariant::seen_share(const Look& look, const Cell& cell) const {
  if (look.sees) return look.sees(cell.u_mm) ? 1 : 0;
  return look.visible ? look.visible->mean_share(look.receiver, cell.index) : 1;
}

Result<std::vector<double>> ShiftInvariant::light(const Receiver& receiver, std::uint32_t, const Look& look) const {
  const std::size_t channels = geometry_.channels.size(), gloss = gloss_values(look.lobe, channels);
  std::vector<double> e(channels + gloss, 0.0);
  if (!(receiver.p_mm.z() > 0)) return e;
  const View view(geometry_, basis_, receiver);
  for (const Cell& cell : cells_) {
    const double facing = view.facing(cell.u_mm);
    if (!(facing > 0)) continue;
    const double share = seen_share(look, cell);
    if (share == 0) continue;
    std::array<double, 3> f{};
    if (gloss > 0) f = lobe_towards(look.lobe, view.at, cell.u_mm);
    const std::vector<double> average = averages(view, cell);
    for (std::size_t c = 0; c < channels; ++c) e[c] += share * view.factor * facing * average[c];
    for (std::size_t c = 0; c < gloss; ++c)
      e[channels + c] += f[c] * share * view.factor * facing * average[channels == 1 ? 0 : c];
  }
  return e;
}

/// `seen`: by channel, what the cell's irradiance may be off by as it is seen.
void ShiftInvariant::state_gloss(const View& view, const Cell& cell, const Look& look, const std::vector<double>& seen,
                                 const Spot& spot, Estimate& result) const {
  const std::size_t channels = geometry_.channels.size();
  const std::array<double, 3> taken = lobe_towards(look.lobe, view.at, cell.u_mm);
  std::array<double, 3> most = taken, varies{};
  constexpr int points = 32;
  const double half = basis_.half_support();
  for (int k = 0; k < points * points; ++k) {
    const Vec2 tau = Vec2(k % points, k / points) * (2 * half / (points - 1)) - Vec2(half, half);
    const std::array<double, 3> f =
        lobe_towards(look.lobe, view.at, cell.u_mm + geometry_.sampling.spacing_mm.cwiseProduct(tau));
    for (std::size_t c = 0; c < 3; ++c) {
      most[c] = std::max(most[c], f[c]);
      varies[c] = std::max(varies[c], std::abs(f[c] - taken[c]));
    }
  }
  for (std::size_t c = 0; c + channels < result.stated_error.size(); ++c) {
    const std::size_t light = channels == 1 ? 0 : c;
    result.stated_error[channels + c] += most[c] * seen[light] + varies[c] * spot.most[light];
  }
}

Result<Estimate> ShiftInvariant::estimate(const Receiver& receiver, std::uint32_t number, const Look& look) const {
  Estimate result{*light(receiver, number, look), {}};
  result.stated_error.assign(result.irradiance.size(), 0.0);
  if (!(receiver.p_mm.z() > 0)) return result;
  const View view(geometry_, basis_, receiver);
  const std::size_t channels = geometry_.channels.size();
  for (const Cell& cell : cells_) {
    const Spot spot = this->spot(view, cell);
    const double share = seen_share(look, cell);
    // All of a half-seen cell's light may come through what is seen of it, or through what is not. A point tells
    // nothing of the others.
    const bool by_tile = look.visible && look.visible->weighing == ShadowWeighing::tile;
    const double half_seen = look.sees ? 1 : by_tile && share > 0 && share < 1 ? std::max(share, 1 - share) : 0;
    std::vector<double> seen(channels);
    for (std::size_t c = 0; c < channels; ++c) {
      seen[c] = share * spot.off[c] + half_seen * spot.most[c];
      result.stated_error[c] += seen[c];
    }
    if (result.irradiance.size() > channels) state_gloss(view, cell, look, seen, spot, result);
  }
  return result;
}

}  // namespace lumifield
