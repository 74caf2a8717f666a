#pragma once

#include <algorithm>
#include <array>

#include "renderer/methods/axis_weights.h"
#include "renderer/methods/receiver_view.h"
#include "renderer/visibility/tile_grid.h"

namespace lumifield {

/// Part of U, mm.
struct SeenPart {
  Vec2 low, high;
};

/// Calls visit(u, ω, solid angle) for points of a part, ω the direction there from the receiver: three Gauss points an
/// axis, after the part is halved until it shows at most `fine(ω)` radians. fine: of directions.
template <class Fine, class Visit>
void over_part(const ReceiverView& view, const SeenPart& part, int deepest, const Fine& fine, const Visit& visit) {
  const Vec3& p = view.receiver().p_mm;
  const auto from_p = [&](const Vec2& u) { return Vec3(u.x() - p.x(), u.y() - p.y(), -p.z()); };
  const Vec2 center = (part.low + part.high) / 2, size = part.high - part.low;
  const double nearest = from_p(p.head<2>().cwiseMax(part.low).cwiseMin(part.high)).norm();
  if (deepest > 0 && size.maxCoeff() > nearest * fine(Vec3(from_p(center).normalized()))) {
    for (int k = 0; k < 4; ++k) {
      const Vec2 low(k % 2 ? center.x() : part.low.x(), k / 2 ? center.y() : part.low.y());
      const Vec2 high(k % 2 ? part.high.x() : center.x(), k / 2 ? part.high.y() : center.y());
      over_part(view, {low, high}, deepest - 1, fine, visit);
    }
    return;
  }
  constexpr double out = 0.7745966692414834;  // √(3/5)
  constexpr std::array node{-out, 0.0, out}, weight{5.0 / 18, 8.0 / 18, 5.0 / 18};
  for (std::size_t j = 0; j < 3; ++j)
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec2 u = center + 0.5 * size.cwiseProduct(Vec2(node[i], node[j]));
      const Vec3 to = from_p(u);
      const double distance = to.norm();
      visit(u, Vec3(to / distance), weight[i] * weight[j] * size.prod() * p.z() / (distance * distance * distance));
    }
}

/// The same for all of U that shows pixels of S: tile by tile (TileGrid), pixel's part by pixel's part, so that C, φ's
/// pieces and what is seen are smooth on each.
template <class Fine, class Visit>
void over_seen_tiles(const ReceiverView& view, const Fine& fine, const Visit& visit) {
  const LuminaireGeometry& g = view.geometry();
  const Measurement& m = g.measurement;
  const TileGrid grid(g.sampling);
  const Basis tile(BasisKind::box);
  const Vec3& p = view.receiver().p_mm;
  const double delta = g.planes.separation_mm;
  const auto parts = [&](int axis, double center, int pixels) {
    return axis_weights(tile, {delta, p.z(), p[axis]},
                        {center, grid.size_mm[axis], m.corner_mm()[axis], m.pixel_mm[axis], pixels});
  };
  constexpr int deepest = 24;
  for (int row = 0; row < grid.rows; ++row)
    for (int column = 0; column < grid.columns; ++column) {
      const Vec2 center = grid.center_mm(column, row);
      const AxisWeights x = parts(0, center.x(), m.width_px), y = parts(1, center.y(), m.height_px);
      for (const auto& above : y.pixels)
        for (const auto& across : x.pixels) {
          const auto at = [&](double tx, double ty) -> Vec2 {
            return center + grid.size_mm.cwiseProduct(Vec2(tx, ty));
          };
          const SeenPart part{at(across.low, above.low), at(across.high, above.high)};
          if ((part.high - part.low).minCoeff() > 0) over_part(view, part, deepest, fine, visit);
        }
    }
}

}  // namespace lumifield
