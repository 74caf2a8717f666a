#pragma once

#include <memory>
#include <string>
#include <vector>

#include "luminaire/light_field.h"
#include "luminaire/scene.h"
#include "renderer/methods/appearance.h"
#include "renderer/methods/receiver.h"
#include "renderer/opengl/gbuffer.h"
#include "renderer/picture.h"
#include "renderer/visibility/scene_shadows.h"

namespace lumifield {

/// How a study's surfaces look. Value type.
struct StudyLook {
  Visibility visibility = Visibility::none;
  double roughness = 0;  ///< of a GGX lobe with F0 = common_f0 on every surface; 0: they are diffuse alone
  /// "", "in shadow", "GGX 0.2".
  std::string name() const;
  bool plain() const { return visibility == Visibility::none && roughness == 0; }
};

/// What a method says of a frame, per receiver: irradiance of the luminaire's channels, and radiance by gloss.
struct StudyLight {
  std::vector<double> irradiance, gloss;
};

/// One view of a scene as receivers of its first luminaire. What lies behind S is left dark (n = 0) in all methods
/// alike: the published ones have no answer there, and the cases of it are the stability table's. Value type.
struct StudyFrame {
  GBuffer gbuffer;
  std::vector<Material> materials;
  ScenePlacement placement;
  std::vector<Receiver> receivers;  ///< one for each pixel
  Appearance appearance{};          ///< of each

  /// The picture of a frame's light.
  Picture picture(const StudyLight& light, std::size_t channels) const;
  /// What methods are compared by, of the receiver at a pixel that is the k-th of `light`, per channel: irradiance
  /// where all are diffuse; else the radiance ρ/π·E + G, ρ the mean of the surface's reflectances.
  std::vector<double> seen(const StudyLight& light, std::size_t k, std::size_t pixel, std::size_t channels) const;
  /// Some of its receivers alone; their appearance without what is exact by points (Appearance::sees).
  std::vector<Receiver> receivers_at(const std::vector<std::size_t>& chosen) const;
  Appearance appearance_at(const std::vector<std::size_t>& chosen) const;
};

/// One pixel of every stratum of the frame that shows a lit surface, 32×32 strata, seeded.
std::vector<std::size_t> stratified_receivers(const StudyFrame& frame, std::uint32_t seed);

/// Draws frames of one scene. Thread-bound: owns an EGL context.
class StudyCamera {
 public:
  /// Errors: the mesh's, no EGL context, no luminaire in the scene.
  static Result<std::unique_ptr<StudyCamera>> create(const Scene& scene);

  /// What lies behind this luminaire's S is left dark. Errors: those of GBufferPass::draw and SceneShadows::see.
  Result<StudyFrame> frame(int width_px, int height_px, const LightField& light_field, const StudyLook& look = {});

  /// What frames are made with.
  const Scene& scene() const { return scene_; }
  const std::vector<Material>& materials() const { return materials_; }
  GBufferPass& pass() { return *pass_; }
  SceneShadows& shadows() { return *shadows_; }

 private:
  StudyCamera() = default;
  Scene scene_;
  std::unique_ptr<EglContext> context_;
  std::unique_ptr<GBufferPass> pass_;
  std::unique_ptr<SceneShadows> shadows_;
  std::vector<Material> materials_;
};

}  // namespace lumifield
