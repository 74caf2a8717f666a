#pragma once

#include <memory>
#include <vector>

#include "luminaire/scene.h"
#include "renderer/methods/closed_form.h"
#include "renderer/opengl/gbuffer.h"
#include "renderer/picture.h"

namespace lumifield {

/// One view of a scene as receivers of its first luminaire. What lies behind S is left dark (n = 0) in all methods
/// alike: the published ones have no answer there, and the cases of it are the stability table's. Value type.
struct StudyFrame {
  GBuffer gbuffer;
  std::vector<Material> materials;
  ScenePlacement placement;
  std::vector<Receiver> receivers;  ///< one for each pixel

  /// The picture of a frame's irradiance.
  Picture picture(const std::vector<double>& irradiance, std::size_t channels) const;
};

/// One pixel of every stratum of the frame that shows a lit surface, 32×32 strata, seeded.
std::vector<std::size_t> stratified_receivers(const StudyFrame& frame, std::uint32_t seed);

/// Draws frames of one scene. Thread-bound: owns an EGL context.
class StudyCamera {
 public:
  /// Errors: the mesh's, no EGL context, no luminaire in the scene.
  static Result<std::unique_ptr<StudyCamera>> create(const Scene& scene);

  /// separation_mm: S, behind which all is left dark.
  Result<StudyFrame> frame(int width_px, int height_px, double separation_mm);

 private:
  StudyCamera() = default;
  Scene scene_;
  std::unique_ptr<EglContext> context_;
  std::unique_ptr<GBufferPass> pass_;
  std::vector<Material> materials_;
};

}  // namespace lumifield
