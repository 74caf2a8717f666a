#pragma once

#include <optional>
#include <span>
#include <vector>

#include "luminaire/light_field.h"
#include "renderer/opengl/gl_objects.h"
#include "renderer/shift_invariant/spot_settings.h"
#include "renderer/visibility/shadow_map_pass.h"

namespace lumifield {

/// The view of a cell's depth map: from its centre u_m through the images on S, widened by half a support a side: a
/// light ray of the cell that passes the images at s on its way to a receiver with Δ ≥ −δ/2 passes S, as seen from u_m,
/// at most half a support beside s. A receiver outside the map is lit.
ShadowView spot_view(const LuminaireGeometry& geometry, CellIndex cell, int map_px);

/// What is kept of a receiver's depth in a test by it: 1 − the bias (shadow_plan.h).
double spot_depth_kept(const ShadowView& view, int map_px);

/// The depth maps of a luminaire's cells in a scene, a layer of an array texture each, made when they are first asked
/// for and kept until light or scene move. Thread-bound to the context that is current when they are made.
class SpotDepths {
 public:
  /// Forgets the maps, unless they are of this. `pose`: luminaire → scene, rigid. Errors: more maps than
  /// max_shadow_texels or than the device has layers for.
  Status set(const Pose& pose, const LuminaireGeometry& geometry, int map_px);
  /// Draws those of the cells that are not there.
  Status draw(ShadowMapPass& pass, std::span<const CellIndex> cells);
  void forget();
  void bind(int unit);
  /// Maps drawn, in all.
  int drawn() const { return drawn_; }

 private:
  Status make_room();

  std::optional<Pose> pose_;
  LuminaireGeometry geometry_;
  int map_px_ = 0;
  std::vector<bool> there_;  ///< by Sampling::flat
  int drawn_ = 0;
  GlTexture texture_;
};

}  // namespace lumifield
