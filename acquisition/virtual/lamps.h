#pragma once

#include <cmath>
#include <optional>
#include <string_view>
#include <vector>

#include "luminaire/geometry.h"

namespace lumifield::virtual_bench {

/// Distance of the planes U and S of every virtual bench, δ.
inline constexpr double plane_separation_mm = 150;

/// What a mono camera sees of R, G, B.
inline const Eigen::Array3d mono_weights{0.25, 0.60, 0.15};

/// One axis of a separable term of the emission: a window on the exit times a lobe in slope m = (s − u)/δ whose centre
/// may bend with u (a curved facet), times an edge in slope (a cut-off),
///
///     F(u, m) = w((u − center)/half) · exp(−½((m − c(u))/sigma)²) · 1/(1 + exp((m − edge)/edge_width)),
///     w(t) = (1 − t²)² on |t| ≤ 1,   c(u) = slope + bend (u − center).
///
/// C¹ in u, analytic inside the window. edge_width > 0 passes slopes below the edge, < 0 those above, 0 = no edge.
struct AxisTerm {
  double center_mm = 0, half_mm = 1;
  double slope = 0, bend_per_mm = 0, sigma = 1;
  double edge = 0, edge_width = 0;

  double low_mm() const { return center_mm - half_mm; }
  double high_mm() const { return center_mm + half_mm; }
  double lobe_center(double u) const { return slope + bend_per_mm * (u - center_mm); }
  /// Length in u over which F, seen from a point of S, is a low polynomial.
  double detail_mm() const;
  double window(double u) const;
  /// Lobe and edge, M being double or Eigen::ArrayXd.
  template <class M>
  M lobe(double u, const M& m) const {
    using std::exp;
    const M t = (m - lobe_center(u)) / sigma, gauss = exp(-0.5 * t * t);
    if (edge_width == 0) return gauss;
    return gauss / (1 + exp((m - edge) / edge_width));
  }
};

struct LampTerm {
  Eigen::Array3d radiance;  ///< R, G, B, W/(m² sr)
  AxisTerm x, y;
};

/// A lamp whose emission L·cos⁴θ is a sum of terms separable in x and y, so that its irradiance on S behind a separable
/// filter is a sum of products of 1-D integrals: L(u→s) = (1/cos⁴θ) Σ_k A_k X_k(u_x, m_x) Y_k(u_y, m_y). Every lamp has
/// an asymmetric mark, one tilted bright facet in one quadrant of the exit and of the directions. Value type.
struct Lamp {
  Vec2 size_mm{36, 22};
  std::vector<LampTerm> terms;

  /// L in R, G, B of the ray that leaves u (mm on U) with slopes m.
  Eigen::Array3d radiance(const Vec2& u, const Vec2& m) const;
};

/// "bike": filament and facetted reflector; "headlight": cut-off in m_y, higher where m_x > 0; "led-array": 4×3 lensed
/// LEDs, warm to cool over the exit. Empty for another name.
std::optional<Lamp> make_lamp(std::string_view name);

}  // namespace lumifield::virtual_bench
