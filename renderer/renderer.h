#pragma once

#include <memory>
#include <string>
#include <vector>

#include "luminaire/error.h"
#include "luminaire/light_field.h"
#include "luminaire/scene.h"
#include "renderer/picture.h"

namespace lumifield {

struct RendererInfo {
  std::string opengl;  ///< renderer and version
  std::string opencl;  ///< device
  std::vector<std::string> notes;  ///< what the picture does not show of the scene
};

/// The live picture: a scene lit by the part of a luminaire that is measured. Thread-bound to the render thread, which
/// owns its EGL context and OpenCL queue for life. OpenGL makes the G-buffer once per view or scene; OpenCL adds cells to
/// the running sum of irradiance. Diffuse and unshadowed.
class Renderer {
 public:
  /// Errors: no EGL context, no OpenCL device, the mesh's, a scene without a luminaire or with a pose that is not rigid.
  static Result<std::unique_ptr<Renderer>> create(const Scene& scene, int width_px, int height_px);
  ~Renderer();

  RendererInfo info() const;

  /// Forgets all cells and takes another luminaire. It stands at every placement of the scene; their light adds up.
  Status set_luminaire(const LuminaireGeometry& geometry);
  /// Another view: all cells are added again.
  Status set_view(const SceneCamera& camera, int width_px, int height_px);

  /// Adds or replaces one cell; the image is kept for changes of view. After an error of the device the next picture
  /// sums all cells again.
  Status add_cell(CellIndex cell, std::shared_ptr<const CellImage> image);
  Status add_all(const LightField& light_field);

  /// radiance = reflectance/π · Σ scale·E.
  Result<Picture> picture();
  /// Kernel time of the last add over all placements, seconds.
  double last_kernel_s() const;

 private:
  struct Impl;
  explicit Renderer(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

/// What this machine offers, for `lumifield devices`: an Error's message says why not and the remedy.
Result<std::string> probe_opengl();
Result<std::string> probe_opencl();

}  // namespace lumifield
