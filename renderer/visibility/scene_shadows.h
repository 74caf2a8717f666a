#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "luminaire/scene.h"
#include "renderer/methods/appearance.h"
#include "renderer/methods/table_memory.h"
#include "renderer/visibility/ray_visibility.h"
#include "renderer/visibility/tile_shadows.h"
#include "renderer/visibility/visibility.h"

namespace lumifield {

/// What the receivers of a scene see of its luminaires, each placement of the one light field by itself. Depth maps and
/// the rays' trees are kept until light or scene move. Published positions are those of the first cells that gave
/// each tile one, until they are forgotten. Thread-bound to the context's thread; the context must outlive it.
class SceneShadows {
 public:
  /// `memory_bytes`: half of it may be taken for what all receivers see.
  SceneShadows(EglContext& context, Mesh mesh, double memory_bytes = host_memory_bytes())
      : context_(context), mesh_(std::move(mesh)), memory_bytes_(memory_bytes) {}

  /// Placements that keep their maps; of more than these a few make them anew for each view.
  static constexpr std::size_t most_kept = 16;
  /// A coarse map: as many tiles an axis share it, of so many texels a side.
  static constexpr int coarse_tiles = 3, coarse_px = 96;

  /// Sets `appearance.visible` of all placements' receivers in turn (shading.h), 4 floats each, luminaire frames, and
  /// of rays `appearance.sees`. `coarse`: maps that have to be made are coarse ones. Errors: more
  /// receivers than memory, published positions that have not been taken, those of TileShadows and RayVisibility.
  Status see(const std::vector<ScenePlacement>& placements, const LuminaireGeometry& geometry, Visibility visibility,
             bool coarse, std::span<const float> p_xyzw, std::span<const float> face_xyzw, Appearance& appearance);

  /// Gives published positions to tiles that have none.
  void take_positions(const LightField& light_field);
  /// The next ones are of the cells of then.
  void forget_positions() { positions_.reset(); }
  /// Of another luminaire: neither positions nor maps are those of the one before.
  void forget_luminaire();
  /// Whether a cell gives a tile its first published position.
  bool gives_position(const LuminaireGeometry& geometry, CellIndex cell) const;
  const Mesh& mesh() const { return mesh_; }
  /// How often maps have been made, of all placements.
  int times_made() const;

 private:
  struct Lamp {
    std::unique_ptr<TileShadows> fine, coarse;
    std::optional<Pose> fine_pose;
    ShadowSettings fine_settings;
    std::optional<TilePositions> fine_positions;
  };
  Result<TileVisibility> by_maps(std::size_t number, const Pose& pose, const LuminaireGeometry& geometry,
                                 Visibility visibility, bool coarse, std::span<const float> p,
                                 std::span<const float> n);
  Result<TileVisibility> by_rays(std::size_t number, const Pose& pose, const LuminaireGeometry& geometry,
                                 std::span<const float> p, std::span<const float> n);
  Result<TileShadows*> shadows_of(std::unique_ptr<TileShadows>& shadows);

  EglContext& context_;
  Mesh mesh_;
  double memory_bytes_;
  std::vector<Lamp> lamps_;
  std::optional<TilePositions> positions_;
  struct Rays {
    Pose pose;
    std::shared_ptr<const RayVisibility> by;
  };
  std::vector<Rays> rays_;  ///< of the last placements seen by rays
};

/// Of what a receiver sees of one placement, bytes.
std::size_t visibility_bytes(const LuminaireGeometry& geometry, Visibility visibility);

}  // namespace lumifield
