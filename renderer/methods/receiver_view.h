#pragma once

#include <array>

#include "luminaire/basis.h"
#include "renderer/methods/look.h"
#include "renderer/methods/receiver.h"
#include "renderer/sampling/summed_area_table.h"

namespace lumifield {

/// A receiver before the planes, and what it sees of a cell: the support of Φ_m, τ = (u − u_m)/a on [−h, h]², and its
/// image on S, an axis-parallel box (Lu 2015, Eq. 7) that swaps its ends between the planes and shrinks to a point on
/// S. In τ the irradiance has no pole anywhere before U:
///
///     E_m = δ² a_x a_y/(δ+Δ)³ ∫∫ C_m(s(τ)) φ(τ_x) φ(τ_y) max(0, n·(u−p)) dτ
///
/// Value type; refers to the geometry. Safe from any thread.
class ReceiverView {
 public:
  ReceiverView(const LuminaireGeometry& geometry, const Basis& basis, const Receiver& receiver, const Look& look = {});

  /// In front of U: else the irradiance is 0.
  bool in_front() const { return receiver_.p_mm.z() > 0; }
  double delta_mm() const { return receiver_.p_mm.z() - geometry_->planes.separation_mm; }  ///< Δ
  /// Pixels of S per unit of τ, negative between the planes.
  const Vec2& rate() const { return rate_; }
  double half_support() const { return half_; }
  /// Fewest pixels that the support spans on an axis.
  double span_px() const { return 2 * half_ * rate_.cwiseAbs().minCoeff(); }

  /// Where u = u_m + a τ shows on S, in pixels from the corner of the image.
  Vec2 on_s_px(const Vec2& u_m, const Vec2& tau) const;
  /// The support as seen on S, ends in order, not clipped to the image.
  PixelBox box(const Vec2& u_m) const;
  /// The inverse of on_s_px, where S is not at p.
  Vec2 tau(const Vec2& u_m, const Vec2& on_s_px) const;

  /// δ² a_x a_y/(δ+Δ)³ φ(τ_x) φ(τ_y) max(0, n·(u−p)): irradiance per unit of C and of τ².
  double weight(const Vec2& u_m, const Vec2& tau) const;

  /// What a light in cell `number` at τ is multiplied by: the same times what is seen of it, and that times the lobe,
  /// by colour.
  struct Weights {
    double irradiance = 0;
    std::array<double, 3> gloss{};
  };
  Weights weights(std::uint32_t number, const Vec2& tau) const;
  /// What is seen of the light of a cell from τ, 0 … 1.
  double seen(CellIndex cell, const Vec2& tau) const;
  /// Values of a receiver: irradiance by channel, then radiance by gloss (gloss_values).
  std::size_t values() const { return channels_ + gloss_; }
  /// Calls visit(k, w · C) for each of them, C by channel of a pixel.
  template <class Light, class Visit>
  void over_values(const Weights& w, const Light& light, const Visit& visit) const {
    for (std::size_t c = 0; c < channels_; ++c) visit(c, w.irradiance * light(c));
    for (std::size_t c = 0; c < gloss_; ++c) visit(channels_ + c, w.gloss[c] * light(channels_ == 1 ? 0 : c));
  }

  const LuminaireGeometry& geometry() const { return *geometry_; }
  const Receiver& receiver() const { return receiver_; }
  const Basis& basis() const { return *basis_; }
  const Look& look() const { return look_; }

 private:
  const LuminaireGeometry* geometry_;
  const Basis* basis_;
  Receiver receiver_;
  Look look_;
  std::size_t channels_, gloss_;
  double half_, factor_ = 0;
  Vec2 rate_{0, 0};
};

}  // namespace lumifield
