#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "luminaire/light_field.h"

namespace lumifield {

/// A luminaire made from a seed, to study methods on: lobes that leave the lamp in common directions, each through some
/// of the cells, on a faint ground, C_m(s) = Σ_b w_mb exp(−|s − u_m − d_b|²/2σ_b²) + ground; a cut-off leaves all above
/// a direction dark but for the ground. Not negative, of unit "relative".
struct SyntheticLuminaire {
  std::string_view name;
  BasisKind basis = BasisKind::bell;
  double separation_mm = 150, spacing_mm = 7.5;
  int columns = 9, rows = 7;
  int pixels = 300;  ///< of width and height
  double pixel_mm = 1;
  int lobes = 24;
  double spread_mm = 90;                              ///< of the lobes' places d_b on S
  double least_width_mm = 3, greatest_width_mm = 25;  ///< σ_b
  std::optional<double> cut_off_mm{};                 ///< d_y above which it is dark
  std::uint32_t seed = 1;
};

/// The sizes of Lu, Pacanowski, Granier 2015, Table 1: bike 9×7 cells of 300×300 (bell, support 15 mm), car1 5×5 and
/// car2 11×9 of 256×256 (bspline2, support 49.5 mm). What the paper does not tell is chosen here: the planes'
/// separation, the pixels' size, and the light.
std::span<const SyntheticLuminaire> table_1_luminaires();

/// channels: 1 or 3.
LightField make_luminaire(const SyntheticLuminaire& synthetic, int channels = 1);

}  // namespace lumifield
