#pragma once

#include <array>

#include "renderer/environment/lat_long.h"

namespace lumifield {

/// An environment's irradiance, by real spherical harmonics of degrees 0, 1, 2 (Ramamoorthi, Hanrahan 2001): nine
/// coefficients a colour,
///
///     E(n) = Σ_lm A_l L_lm Y_lm(n),   A_0 = π, A_1 = 2π/3, A_2 = π/4.
///
/// L_lm is exact for the image as it is, constant on its pixels, however few: Y_lm is integrated over each in closed
/// form. What is left out is that of degree 4 and more: of a small source, whose E at an angle γ from it is Φ max(0,
/// cos γ), the nine give Φ (1/4 + cos γ/2 + 5/32 (3 cos² γ − 1)), from 4 % of Φ too little to 9 % too much (γ = 90°),
/// and −4 % of Φ at 122°, where there is none. Value type, immutable, safe from any thread.
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
