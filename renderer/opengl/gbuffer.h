#pragma once

#include <memory>
#include <vector>

#include "luminaire/error.h"
#include "luminaire/scene.h"
#include "renderer/opengl/egl_context.h"
#include "renderer/scene/mesh.h"

namespace lumifield {

/// What a camera sees at each pixel's centre, top row first, interleaved in fours. Value type.
///
/// Surfaces are two-sided: the normal is the vertices' interpolated one, turned to the side of the triangle that faces
/// the eye, and of unit length. Background is 0 throughout.
struct GBuffer {
  int width_px = 0, height_px = 0;
  std::vector<float> position;     ///< x, y, z in mm, scene frame; coverage 1 or 0
  std::vector<float> normal;       ///< n in the scene frame; material index
  std::vector<float> face;         ///< the triangle's own normal, of unit length, on the same side; 0
  std::vector<float> reflectance;  ///< diffuse R, G, B; 0. Empty when no material has a texture: Material::diffuse
};

constexpr int max_picture_px = 16384;

/// Draws a mesh into G-buffers. The rasteriser only decides which triangle a pixel sees; position and depth are those
/// of the ray through the pixel's centre with the triangle's plane, in double, so they carry the rounding of float and
/// nothing of the rasteriser's vertex snapping (1/256 pixel): a ray that the snapping puts beside its triangle gets the
/// triangle's nearest barycentric point. Textures are looked up trilinearly, repeated. Thread-bound to the context's
/// thread; the context must outlive it.
class GBufferPass {
 public:
  /// Errors: mesh or textures too large for the device.
  static Result<std::unique_ptr<GBufferPass>> create(EglContext& context, const Mesh& mesh);
  ~GBufferPass();

  /// Errors: a size outside 1 … max_picture_px or the device's own limit, a camera without a direction, out of memory.
  Result<GBuffer> draw(const SceneCamera& camera, int width_px, int height_px);

 private:
  struct Impl;
  explicit GBufferPass(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace lumifield
