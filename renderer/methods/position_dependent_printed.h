#pragma once

#include <vector>

#include "renderer/methods/host_method.h"
#include "renderer/methods/receiver_view.h"
#include "renderer/methods/sampled_cell.h"
#include "renderer/sampling/piecewise_constant_2d.h"
#include "renderer/sampling/sequence.h"

namespace lumifield {

/// Position-dependent importance sampling as Lu, Pacanowski, Granier 2015 print it, so that its bias can be seen:
///
/// - the pair of restricted cdfs (Eq. 8) with the box' integral A_m (Eq. 10), though the density drawn from is not
///   C/A_m (PiecewiseConstant2D);
/// - K_m = the nearest whole number to K A_m/A (Eq. 12), which drops faint cells, and division by it (Eq. 13);
/// - the importance is the luminance, and one point sequence serves all cells (Sec. 6.3).
///
/// Refuses what the print has no answer for: luminance below 0, receivers between the planes (its Δ is a distance), and
/// boxes near S too small for the table's digits; on S itself it samples U (Sec. 3.3). The error it states holds its
/// bias, which follows from the density really drawn from.
class PositionDependentPrinted final : public HostMethod {
 public:
  static Result<std::unique_ptr<PositionDependentPrinted>> create(const LightField& light_field,
                                                                  const MethodSettings& settings);

  using HostMethod::estimate;
  Result<std::vector<double>> light(const Receiver& receiver, std::uint32_t number, const Look& look) const override;
  Result<Estimate> estimate(const Receiver& receiver, std::uint32_t number, const Look& look) const override;

 private:
  PositionDependentPrinted(const LightField& light_field, const MethodSettings& settings);
  /// A_m in τ², or on S the luminance of the pixel at p.
  std::vector<double> areas(const ReceiverView& view) const;

  LuminaireGeometry geometry_;
  Basis basis_;
  MethodSettings settings_;
  std::vector<SampledCell> cells_;
  std::vector<PiecewiseConstant2D> tables_;  ///< of each cell
  PointSet points_;
};

/// Refuses a luminaire that holds a luminance below 0, its cell and pixel named.
Status check_printed_luminaire(const LightField& light_field);

/// Refuses a receiver between the planes, or so near S that the box has no digits.
Status check_printed_receiver(const LuminaireGeometry& geometry, const Receiver& receiver);

/// Fewest pixels of a support beyond S at which the published box still has digits.
inline constexpr double printed_least_span_px = 1e-3;

}  // namespace lumifield
