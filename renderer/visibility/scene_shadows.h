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

/// What the receivers of a scene see of its luminaires, each placement of the one light field by itself. Its depth maps
/// are kept while one stands where it did; all share the device, what draws maps and the rays' tree. Published
/// positions are those of the first cells that gave each tile one, until they are forgotten. Thread-bound to the
/// context's thread; the context must outlive it.
class SceneShadows {
 public:
  /// `memory_bytes`: half of it may be taken for what all receivers see.
  SceneShadows(EglContext& context, Mesh mesh, double memory_bytes = host_memory_bytes())
      : context_(context), mesh_(std::move(mesh)), memory_bytes_(memory_bytes) {}

  /// Placements that keep their maps; of more, the last of these and those after it make them anew for each view.
  static constexpr std::size_t most_kept = 16;
  /// A coarse map: as many tiles an axis share it, of so many texels a side.
  static constexpr int coarse_tiles = 3, coarse_px = 96;

  /// Sets `appearance.visible` of all placements' receivers in turn (shading.h), 4 floats each, luminaire frames, and
  /// of rays `appearance.sees`. `coarse`: maps that have to be made are coarse ones. Errors: more
  /// receivers than memory, published positions that have not been taken, those of TileShadows and RayVisibility.
  Status see(const std::vector<ScenePlacement>& placements, const LuminaireGeometry& geometry, Visibility visibility,
             bool coarse, std::span<const float> p_xyzw, std::span<const float> face_xyzw, Appearance& appearance);

  /// Gives published positions to tiles that have none, of all cells (FirstPositions::take).
  void take_positions(const LuminaireGeometry& geometry, std::span<const std::shared_ptr<const CellImage>> cells);
  /// The next ones are of the cells of then.
  void forget_positions() { positions_.reset(); }
  /// Whether a cell's image gives a tile its first published position.
  bool gives_position(const LuminaireGeometry& geometry, CellIndex cell, const std::shared_ptr<const CellImage>& image);
  const Mesh& mesh() const { return mesh_; }
  /// How often maps have been made, of all placements that there are or were.
  int times_made() const { return times_made_; }
  /// Placements that there is room kept for on the devices.
  std::size_t lamps_kept() const { return lamps_.size(); }

 private:
  struct Lamp {
    std::unique_ptr<TileShadows> fine, coarse;
    bool is_at(const Pose& pose) const;
  };
  void keep_lamps(const std::vector<ScenePlacement>& placements);
  Result<TileVisibility> by_maps(std::size_t number, const Pose& pose, const LuminaireGeometry& geometry,
                                 Visibility visibility, bool coarse, std::span<const float> p,
                                 std::span<const float> n);
  Result<TileVisibility> by_rays(const Pose& pose, const LuminaireGeometry& geometry, std::span<const float> p,
                                 std::span<const float> n);
  Result<TileShadows*> shadows_of(std::unique_ptr<TileShadows>& shadows);

  EglContext& context_;
  Mesh mesh_;
  double memory_bytes_;
  std::unique_ptr<TileShadows> model_;  ///< that the lamps' share device and tools of; without maps
  std::vector<Lamp> lamps_;
  int times_made_ = 0;
  std::optional<FirstPositions> positions_;
  std::optional<RayVisibility> rays_;  ///< of the last placement seen by rays
};

/// Of what a receiver sees of one placement, bytes.
std::size_t visibility_bytes(const LuminaireGeometry& geometry, Visibility visibility);

}  // namespace lumifield
