#pragma once

#include <array>

#include "renderer/environment/lat_long.h"

namespace lumifield {

/// An environment's irradiance, by real spherical harmonics of degrees 0, 1, 2 (Ramamoorthi, Hanrahan 2001): nine
/// coefficients a colour,
///
///     E(n) = Σ_lm A_l L_lm Y_lm(n),   A_0 = π, A_1 = 2π/3, A_2 = π/4.
///
/// What is left out is that of degree 4 and more: small for any environment, and below 0 at places where a single
/// bright source is behind. Value type, immutable, safe from any thread.
class IrradianceHarmonics {
 public:
  explicit IrradianceHarmonics(const LatLong& environment);

  /// E per unit of L, by colour. n: of unit length.
  std::array<double, 3> irradiance(const Vec3& n) const;

  static constexpr std::size_t count = 9;
  /// Y_lm in the order (0,0), (1,−1), (1,0), (1,1), (2,−2) … (2,2).
  static std::array<double, count> basis(const Vec3& direction);

 private:
  std::array<std::array<double, 3>, count> reflected_{};  ///< A_l L_lm
};

}  // namespace lumifield
