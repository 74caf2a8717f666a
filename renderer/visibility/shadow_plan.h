#pragma once

#include <array>
#include <optional>
#include <vector>

#include "luminaire/error.h"
#include "luminaire/light_field.h"
#include "renderer/visibility/shadow_map_pass.h"
#include "renderer/visibility/tile_grid.h"
#include "renderer/visibility/tile_positions.h"
#include "renderer/visibility/tile_visibility.h"

namespace lumifield {

/// Where a tile's depth map is taken from.
///
/// tile_center: from the tile's centre on U. The map shows the images on S, widened by half a tile a side: a light ray
/// of the tile that passes the image at s on its way to a receiver with Δ ≥ −δ/2 passes S, as seen from the centre, at
/// most half a tile beside s. A texel is as large a patch of S for all tiles, moved by a part of one from tile to tile,
/// so that the steps of a shadow's edge do not add up; nothing depends on the cells. A receiver outside the map sees
/// the tile: from Δ = −δ/2 on, no measured light comes to it from there.
///
/// published: from TilePositions on S (Lu 2015, Sec. 6.2), by receivers beyond S; those with Δ ≤ 0 are seen from
/// tile_center's. A tile that has no position is seen by all beyond S.
enum class ShadowPosition { tile_center, published };

struct ShadowSettings {
  ShadowPosition position = ShadowPosition::tile_center;
  ShadowWeighing weighing = ShadowWeighing::tile;
  int map_px = 192;       ///< N, a side
  int tiles_per_map = 1;  ///< b: b×b tiles share a map, taken from the centre of theirs, or the mean of their positions
  /// ε: what is nearer than a receiver's own face by less than this, of its distance along z, is the face itself. 2e-4
  /// covers rounding: positions, normals and planes in float keep the face's distance to some 3·2^-23/cosθ of it, θ
  /// from the face's normal, where the scene's coordinates are not far larger; that is 1e-5 at 88° and 2e-4 at 89.9°.
  /// What leaks through for it is 0.2 mm at 1 m, a fiftieth of a texel of 192 on an image of 300 mm at δ = 150 mm.
  double depth_bias = 2e-4;
  /// What is nearer by less than so many texels is the face too: a relief finer than a map's texel, as a column's
  /// flutes, would else shade itself where the texel's centre meets a ridge. Of a thick body nothing leaks through for
  /// it, of a sheet as much light as falls within so many texels behind it.
  double texel_bias = 1;
  bool operator==(const ShadowSettings&) const = default;
};

/// A published map's half width: the steepest way from the grid to the image, (half image + half grid + |their centres'
/// distance|)/δ, times this. From e beside the light's place s on S a receiver stands in the direction (s − u)/δ +
/// (s − e)/Δ; the widening takes in the second term at Δ ≥ 2δ for |s − e| up to half of (half image + half grid).
inline constexpr double published_widening = 1.25;

/// Which maps the tiles need. `maps_of[0]` are those from U, `maps_of[1]` those from S, none unless published: by block
/// of tiles, row by row, the number of its view; −1: none. Value type, luminaire frame.
struct ShadowPlan {
  TileGrid grid;
  int block = 1;              ///< tiles_per_map
  int columns = 0, rows = 0;  ///< of blocks
  double separation_mm = 0;
  std::vector<ShadowView> views;
  std::array<std::vector<int>, 2> maps_of;
  bool operator==(const ShadowPlan&) const = default;
};

/// From e on U: the images on S, widened by `half_mm` a side, half of what of U sees by the map.
ShadowView view_from_u(const LuminaireGeometry& geometry, const Vec2& e_mm, const Vec2& half_mm);

/// The view one texel wider, its texels moved by a part of one that is another for each map: where all maps' texels lay
/// alike the steps of a shadow's edge would add up. The parts are those of the R2 sequence (Roberts 2018).
ShadowView with_own_texels(ShadowView view, int map_px, std::size_t number);

/// Of a map, in shares of the distance along z: ε and the texels' part.
double bias_of(const ShadowView& view, const ShadowSettings& settings);

/// `positions` count where they are published ones. Errors: settings out of their range, a luminaire without a size,
/// positions of another grid or none where they are asked for, more maps than max_shadow_texels.
Result<ShadowPlan> plan_shadows(const LuminaireGeometry& geometry, const ShadowSettings& settings,
                                const std::optional<TilePositions>& positions);

}  // namespace lumifield
