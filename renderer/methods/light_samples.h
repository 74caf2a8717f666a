#pragma once

#include <vector>

#include "renderer/methods/receiver_view.h"
#include "renderer/methods/sampled_cell.h"
#include "renderer/sampling/box_distribution.h"
#include "renderer/sampling/sequence.h"

namespace lumifield {

struct MethodSettings;

/// The cells' images, sampled within what a receiver sees of them: the draws of PositionDependent. Value type; safe
/// from any thread.
class LightSamples {
 public:
  LightSamples(const LightField& light_field, const MethodSettings& settings);

  const std::vector<SampledCell>& cells() const { return cells_; }

  struct Balance {
    std::vector<double> a, kappa;  ///< A_m in τ² (ReceiverView), κ_m: by cell
    bool on_u;                     ///< samples are uniform on U, not by the image
  };
  /// k: samples of the receiver in all.
  Balance balance(const ReceiverView& view, double k) const;
  /// How many each cell gets, of κ_m on average.
  std::vector<int> counts(const Balance& balance, std::uint32_t number) const;

  /// Calls visit(τ, i, j) for so many samples of a cell; those that show no pixel are left out.
  template <class Visit>
  void over_draws(const ReceiverView& view, std::uint32_t number, const SampledCell& cell, bool on_u, int count,
                  const Visit& visit) const;

  /// Pixels of the support's shorter side below which samples are uniform on U.
  static constexpr double least_span_px = 4;

 private:
  std::vector<SampledCell> cells_;
  PointSet points_;
  std::uint32_t seed_;
  double k_max_;
  Inversion inversion_;
  int depth_;
};

/// The mean over the pixels that a support touches, near S.
double mean_importance(const ReceiverView& view, const SampledCell& cell);

/// The pixel under a point of U; false where it is beside the image.
bool pixel_under(const ReceiverView& view, const Vec2& u_m, const Vec2& tau, int& i, int& j);

template <class Visit>
void LightSamples::over_draws(const ReceiverView& view, std::uint32_t number, const SampledCell& cell, bool on_u,
                              int count, const Visit& visit) const {
  const double half = view.half_support();
  const BoxDistribution box(cell.importance, view.box(cell.u_mm));
  for (int k = 0; k < count; ++k) {
    const UnitPoint xi = points_.at(cell.number, number, k);
    if (!on_u) {
      if (const auto point = box.sample(xi.x, xi.y, inversion_, depth_))
        visit(view.tau(cell.u_mm, {point->x, point->y}), point->i, point->j);
      continue;
    }
    int i = 0, j = 0;
    const Vec2 tau(half * (2.0 * xi.x - 1), half * (2.0 * xi.y - 1));
    if (pixel_under(view, cell.u_mm, tau, i, j)) visit(tau, i, j);
  }
}

}  // namespace lumifield
