#pragma once

#include <memory>
#include <vector>

#include "renderer/methods/axis_weights.h"
#include "renderer/methods/host_method.h"
#include "renderer/shift_invariant/spot_images.h"
#include "renderer/shift_invariant/spot_settings.h"

namespace lumifield {

/// Each measured cell as a textured spotlight at its centre u_m (Granier et al. 2003, Eq. 14, with the factor δ²/cos⁴θ
/// that the model has):
///
///     E_m(p, n) = V_m A f_m E′_m(p),  f_m = cosθ cosθ′/d²,  E′_m(p) = (1/A) ∫ C_m(s(u)) δ²/cos⁴θ Φ_m(u) du
///
/// with θ, θ′ and d of the ray from u_m to p, A = a_x a_y, and s(u) the point of S on the ray from u to p. With E′ so
/// weighted this is the closed form without its terms in W1:
///
///     E_m = V_m δ² A/(δ+Δ)³ max(0, n·(u_m − p)) Σ_ij C_ij W0_i W0_j
///
/// Of a support that the receiver's horizon cuts all counts where its centre is above, and nothing where it is below:
/// cosθ′ is that of the centre, not below 0. V_m is the mean of the tests of the cell's tiles, or that of its centre
/// where the look tells by point; the lobe of gloss is that towards the centre.
///
/// The stated error is the sum over the cells of what each is off by at most: the two W1 terms, of a cut support
/// ∫|C Φ| |n·(u − u_m)|, and of a textured look-up the difference to the weighted average. A cell whose
/// tiles are seen in part, each weighed by itself, may be off by all of its light that is seen, or that is not. Of
/// gloss its peak times that, and the most that the lobe differs from the centre's, over 32×32 points of the support.
/// Reentrant.
class ShiftInvariant final : public HostMethod {
 public:
  ShiftInvariant(const LightField& light_field, const SpotSettings& settings);

  using HostMethod::estimate;
  Result<std::vector<double>> light(const Receiver& receiver, std::uint32_t number, const Look& look) const override;
  Result<Estimate> estimate(const Receiver& receiver, std::uint32_t number, const Look& look) const override;

 private:
  struct Cell {
    CellIndex index;
    Vec2 u_mm;
    std::shared_ptr<const CellImage> image;
    std::unique_ptr<SpotImage> levels;  ///< of a textured look-up, else null
  };
  /// A receiver in front of U.
  struct View;
  /// One cell's light on it, by channel: what the method says, and how far that may be off without a look.
  struct Spot {
    std::vector<double> light, off;
    std::vector<double> most;  ///< δ² A/(δ+Δ)³ ∫|C Φ| max(0, n·(u − p)) at most
  };
  std::pair<AxisWeights, AxisWeights> axes(const View& view, const Cell& cell) const;
  std::vector<double> averages(const View& view, const Cell& cell) const;
  Spot spot(const View& view, const Cell& cell) const;
  double seen_share(const Look& look, const Cell& cell) const;
  void state_gloss(const View& view, const Cell& cell, const Look& look, const std::vector<double>& seen,
                   const Spot& spot, Estimate& result) const;

  LuminaireGeometry geometry_;
  Basis basis_;
  SpotSettings settings_;
  std::vector<Cell> cells_;
};

}  // namespace lumifield
