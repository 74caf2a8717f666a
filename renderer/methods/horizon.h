#pragma once

#include "luminaire/basis.h"

namespace lumifield {

/// n·(u − p) over a support: g = k + x·τ_x + y·τ_y in basis coordinates, linear in u.
struct HorizonPlane {
  double k, x, y;
  double operator()(double tau_x, double tau_y) const { return k + x * tau_x + y * tau_y; }
};

struct BasisRectangle {
  double x0, x1, y0, y1;
};

/// Least and greatest g over a rectangle.
double lowest(const HorizonPlane& g, const BasisRectangle& r);
double highest(const HorizonPlane& g, const BasisRectangle& r);

/// ∬ φ(τ_x) φ(τ_y) max(0, g) over a rectangle: split at the knots, clipped against g = 0, triangulated, and integrated
/// by the seven-point rule of degree 5 (Radon 1948), which is exact for the polynomial pieces.
double clipped_integral(const Basis& basis, const HorizonPlane& g, const BasisRectangle& rectangle);

}  // namespace lumifield
