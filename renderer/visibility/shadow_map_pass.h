#pragma once

#include <memory>
#include <span>
#include <vector>

#include "luminaire/error.h"
#include "luminaire/geometry.h"
#include "renderer/opengl/egl_context.h"
#include "renderer/scene/mesh.h"

namespace lumifield {

/// Where a depth map is taken from and what it shows: from `eye_mm` along the luminaire's +z, directions (x/z, y/z)
/// from `low` to `high`. Value type, luminaire frame.
struct ShadowView {
  Vec3 eye_mm{0, 0, 0};
  Vec2 low{-1, -1}, high{1, 1};
  bool operator==(const ShadowView&) const = default;
};

/// Surfaces nearer to a view's eye along z are not in its map, mm.
inline constexpr double shadow_near_mm = 0.1;

/// Depth maps of a scene, one a view. Value type.
///
/// Texel (i, j) of a map stands for the direction (x/z, y/z) = low + (i + ½, j + ½)·(high − low)/size and holds how far
/// along z the nearest surface is from the eye there, mm, +∞ where none is.
struct ShadowMaps {
  int size_px = 0;  ///< a side
  std::vector<ShadowView> views;
  std::vector<float> depth_mm;  ///< map by map, row by row, low y first

  std::size_t texels() const { return static_cast<std::size_t>(size_px) * static_cast<std::size_t>(size_px); }
};

/// Texels of all maps of a draw, bounded before they are taken: 512 MiB.
inline constexpr std::size_t max_shadow_texels = (std::size_t(512) << 20) / sizeof(float);

/// Draws a mesh into depth maps. Surfaces are two-sided. The rasteriser decides which triangles a texel's centre sees;
/// the depth is that of the ray through the centre with the triangle's plane, to 1e-5 of it, and the least one is kept
/// by blending: there is no depth buffer whose steps could hide what is near behind. Vertices are snapped to 1/256
/// texel: a centre that is taken to a triangle beside it gets a depth that the triangle has. Thread-bound to the
/// context's thread; the context must outlive it.
class ShadowMapPass {
 public:
  /// Errors: mesh too large for the device's memory.
  static Result<std::unique_ptr<ShadowMapPass>> create(EglContext& context, const Mesh& mesh);
  ~ShadowMapPass();

  /// `pose`: luminaire → scene, rigid. Errors: no size, more texels than max_shadow_texels or than an image of the
  /// device holds, a view without a width, out of memory.
  Result<ShadowMaps> draw(const Pose& pose, std::span<const ShadowView> views, int size_px);

 private:
  struct Impl;
  explicit ShadowMapPass(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace lumifield
