#include "renderer/methods/axis_weights.h"

#include <algorithm>
#include <cmath>

namespace lumifield {

namespace {

/// s(u_m) − s as seen on S, in the form that does not cancel for this receiver.
double offset_on_s(const ReceiverAxis& receiver, double u, double s) {
  const double t = receiver.t(), r = receiver.r(), p = receiver.p_mm;
  return std::abs(r) < std::abs(t) ? (p - s) + r * (u - p) : (u - s) + t * (p - u);
}

/// Moments of one pixel [low, high]; `width` is its exact width where no knot cuts it.
AxisWeights::Pixel pixel_moments(const Basis& basis, double low, double high, double width) {
  const double half = basis.half_support();
  AxisWeights::Pixel pixel{std::max(low, -half), std::min(high, half), 0, 0, 0};
  if (low > -half && high < half) pixel.width = width;
  for (const Basis::Piece& piece : basis.pieces()) {
    const double a = std::max(low, piece.begin), b = std::min(high, piece.end);
    if (a >= b) continue;
    // Midpoint rule with its second-derivative term: exact to degree 3.
    const double w = a == low && b == high ? width : b - a, m = (a + b) / 2;
    const double w0 = w * (piece(m) + piece.c[2] * w * w / 12);
    pixel.w0 += w0;
    pixel.w1 += m * w0 + w * w * w / 12 * (piece.c[1] + 2 * piece.c[2] * m);
  }
  return pixel;
}

}  // namespace

AxisWeights axis_weights(const Basis& basis, const ReceiverAxis& receiver, const CellAxis& cell) {
  const double half = basis.half_support();
  // Pixels per unit of τ, negative where the pixel order reverses; the support's centre in pixels.
  const double rate = receiver.r() * cell.spacing_mm / cell.pixel_mm;
  const double sigma = offset_on_s(receiver, cell.u_mm, cell.corner_mm) / cell.pixel_mm;
  const double reach = std::abs(rate) * half;
  if (!(sigma + reach >= -1 && sigma - reach <= cell.pixels + 1.0)) return {};

  // Whole and fractional part about the nearest edge.
  const double nearest = std::round(sigma);
  const double edge_mm = cell.corner_mm + nearest * cell.pixel_mm;
  const double fraction = offset_on_s(receiver, cell.u_mm, edge_mm) / cell.pixel_mm;

  // On S the whole support shows one half-open pixel.
  if (rate == 0) {
    const double pixel = fraction >= 0 ? nearest : nearest - 1;
    if (pixel < 0 || pixel >= cell.pixels) return {};
    return {static_cast<int>(pixel), {{-half, half, basis.moment(0, -half, half), 0}}};
  }

  const int first = static_cast<int>(std::clamp(std::floor(sigma - reach) - 1, 0.0, double(cell.pixels)));
  const int last = static_cast<int>(std::clamp(std::ceil(sigma + reach) + 1, 0.0, double(cell.pixels)));
  AxisWeights weights{first, {}};
  for (int i = first; i < last; ++i) {
    const double x0 = ((i - nearest) - fraction) / rate, x1 = ((i + 1 - nearest) - fraction) / rate;
    weights.pixels.push_back(pixel_moments(basis, std::min(x0, x1), std::max(x0, x1), 1 / std::abs(rate)));
  }
  return weights;
}

}  // namespace lumifield
