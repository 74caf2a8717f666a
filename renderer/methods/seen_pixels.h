#pragma once

#include "renderer/methods/axis_weights.h"
#include "renderer/methods/receiver_view.h"
#include "renderer/methods/sampled_cell.h"

namespace lumifield {

/// Calls visit(i, j, τ, area) for points of the support that show pixels of the image: three midpoints an axis in each
/// pixel's part, with their area in τ². Parts are exact on and near S too, where positions in pixels have no digits
/// left.
template <class Visit>
void over_seen_pixels(const ReceiverView& view, const Vec2& u_m, const Visit& visit) {
  const LuminaireGeometry& g = view.geometry();
  const Measurement& m = g.measurement;
  const Vec3& p = view.receiver().p_mm;
  const Vec2 corner = m.corner_mm();
  const double delta = g.planes.separation_mm;
  const AxisWeights x = axis_weights(view.basis(), {delta, p.z(), p.x()},
                                     {u_m.x(), g.sampling.spacing_mm.x(), corner.x(), m.pixel_mm.x(), m.width_px});
  const AxisWeights y = axis_weights(view.basis(), {delta, p.z(), p.y()},
                                     {u_m.y(), g.sampling.spacing_mm.y(), corner.y(), m.pixel_mm.y(), m.height_px});
  constexpr int points = 3;
  for (std::size_t j = 0; j < y.pixels.size(); ++j)
    for (std::size_t i = 0; i < x.pixels.size(); ++i) {
      const Vec2 low(x.pixels[i].low, y.pixels[j].low), high(x.pixels[i].high, y.pixels[j].high);
      const Vec2 part = (high - low) / points;
      if (!(part.minCoeff() > 0)) continue;
      for (int k = 0; k < points * points; ++k)
        visit(x.first + static_cast<int>(i), y.first + static_cast<int>(j),
              Vec2(low + part.cwiseProduct(Vec2(k % points + 0.5, k / points + 0.5))), part.prod());
    }
}

/// Adds ∫ scale (F C)² dτ over what is seen of a cell, by value of the receiver: the variance of a sample of density q
/// is at most that of 1/q. scale(i, j): of a pixel, not negative.
template <class Scale>
void add_variance(const ReceiverView& view, const MeasuredCell& cell, const Scale& scale,
                  std::vector<double>& variance) {
  over_seen_pixels(view, cell.u_mm, [&](int i, int j, const Vec2& tau, double area) {
    const double each = area * scale(i, j);
    view.over_values(view.weights(cell.number, tau), of_pixel(cell, i, j),
                     [&](std::size_t k, double f) { variance[k] += each * f * f; });
  });
}

}  // namespace lumifield
