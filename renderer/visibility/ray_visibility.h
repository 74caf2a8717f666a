#pragma once

#include <memory>
#include <span>

#include "luminaire/error.h"
#include "luminaire/geometry.h"
#include "renderer/scene/mesh.h"
#include "renderer/visibility/tile_visibility.h"

namespace lumifield {

/// Who sees what by rays, exactly: what shadow maps are judged by, and what reference pictures are made with. Surfaces
/// are two-sided. Luminaire frame, mm. Value type, safe from any thread; copies share the scene's tree.
///
/// A ray sets out from the receiver moved by `offset_mm` along its face normal, to the side of where it goes, so that
/// the receiver's own surface does not stand in its way, on either side: what else is nearer than that cannot be told
/// from it.
class RayVisibility {
 public:
  /// `pose`: luminaire → scene, rigid. Errors: a processor that Embree does not know, out of memory.
  static Result<RayVisibility> create(const Mesh& mesh, const Pose& pose);
  /// In the same scene, of a luminaire at another pose: shares the tree.
  RayVisibility at(const Pose& pose) const;

  /// Whether nothing stands between p, on a face with the unit normal `face_n`, and u.
  bool sees(const Vec3& p_mm, const Vec3& face_n, const Vec3& u_mm) const;

  /// The tiles' centres, of receivers given as TileShadows takes them: one with n = 0, and one that is not in front of
  /// U, sees nothing.
  TileVisibility see_tiles(const TileGrid& grid, std::span<const float> p_xyzw, std::span<const float> face_xyzw,
                           ShadowWeighing weighing = ShadowWeighing::tile) const;

  /// 16 roundings to float of the largest coordinate of the mesh's box, as the scene has it or the luminaire: the
  /// receiver has been rounded in either frame, each coordinate by half a step, and the ray's origin is.
  double offset_mm() const { return offset_mm_; }

 private:
  struct Tree;
  RayVisibility(std::shared_ptr<const Tree> tree, const Pose& pose);
  std::shared_ptr<const Tree> tree_;
  Pose pose_;
  double offset_mm_;
};

}  // namespace lumifield
