#pragma once

#include <array>
#include <vector>

#include "acquisition/virtual/lamps.h"
#include "acquisition/virtual/lens.h"
#include "acquisition/virtual/slide.h"

namespace lumifield::virtual_bench {

/// Irradiance on the diffuse screen, plane S, at the nodes of a regular grid, W/m². Behind the slide
///
///     E(s) = ∫_U T L cos²θ/R² du = 1/δ² Σ_terms Σ_parts (∫ f± X dx)(∫ f± Y dy)/k,      R = δ/cosθ:
///
/// 1-D integrals by Gauss–Legendre panels between the filter's knots and sign changes, then one matrix product per
/// band.
using Plane = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

struct ScreenGrid {
  Vec2 corner_mm{0, 0};
  double step_mm = 0.5;
  int columns = 0, rows = 0;

  /// Nodes over ±half_mm around the axis.
  static ScreenGrid covering(const Vec2& half_mm, double step_mm);
  Eigen::ArrayXd nodes(int axis) const;
};

/// Screen irradiance in the bands whose weights on R, G, B are given. Pure.
std::vector<Plane> screen_irradiance(const Lamp& lamp, const Slide& slide, const Bench& bench, const ScreenGrid& grid,
                                     const Vec2& stage_mm, const std::vector<Eigen::Array3d>& bands);

/// What each pixel of the camera sees of a screen plane: bilinear look-up at the pixel's centre, then the mean over its
/// footprint and the lens blur, of standard deviation blur_px, as one kernel on the image. Screen edges are black.
Plane photograph(const Plane& screen, const ScreenGrid& grid, const LensMap& lens, double blur_px);

}  // namespace lumifield::virtual_bench
