#pragma once

#include <functional>
#include <vector>

#include "luminaire/light_field.h"

namespace lumifield {

/// Irradiance by quadrature of its definition, to judge everything that computes it faster:
///
///     E(p, n) = ∫_U L(u→s(u)) cosθ max(0, n·(u−p)) / |u−p|³ du,   L = Σ_m C_m(s) Φ_m(u) δ²/cos⁴θ
///
/// U is split at every knot, at the image u(s) of every pixel edge, and along the horizon; four Gauss points an axis on
/// each piece, where the integrand is a polynomial, leave only rounding. In long double, with basis functions,
/// projection and splitting written here and nowhere else. Shares no code with the methods. Frame: the luminaire's.
/// Safe from any thread.
struct DefinitionValue {
  std::vector<double> irradiance;  ///< per channel, the dataset's irradiance unit
  std::vector<double> magnitude;   ///< the same with |C_m|: what an error is measured against
};

/// What light from a point of U counts with: what is seen of it, or a lobe. Smooth on each part of U between two knots,
/// and on each half of a middle one, which are the tiles.
using PointFactor = std::function<double(CellIndex cell, const Vec2& u_mm)>;

DefinitionValue definition_quadrature(const LightField& light_field, const Vec3& p_mm, const Vec3& n,
                                      const PointFactor& factor = {});

}  // namespace lumifield
