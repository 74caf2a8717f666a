#pragma once

#include "luminaire/light_field.h"

namespace lumifield {

/// What a constant distance of a cell's support makes of the geometric term (Granier et al. 2003, Eq. 11, Fig. 3):
///
///     Er(θ0) = (max cos⁴θ − min cos⁴θ over the support)/cos⁴θ0
///
/// θ from the planes' normal, of rays from the points of a square support on U to one point of S; θ0 that of its
/// centre. `half_support`: of the support's side, in shares of the planes' distance δ: s/2 with the paper's s.
/// `azimuth_rad`: of the direction in which S is seen, from an axis of the support. It is the error of a constant
/// distance in a pair of measuring and reconstructing filters, not of shift_invariant.h, which has cos⁴ of each
/// receiver. 0 ≤ θ0 < π/2; a pure function.
double constant_distance_error(double half_support, double theta0_rad, double azimuth_rad);

/// The largest over the places of S that a cell's image shows, of 33×33 of them, corners included; of the support's
/// longer side.
double largest_constant_distance_error(const LuminaireGeometry& geometry, CellIndex cell);

}  // namespace lumifield
