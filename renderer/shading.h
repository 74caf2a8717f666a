#pragma once

#include <span>
#include <string>
#include <vector>

#include "luminaire/scene.h"
#include "renderer/environment/environment_light.h"
#include "renderer/methods/gloss_shared.h"
#include "renderer/methods/method.h"
#include "renderer/methods/receiver.h"
#include "renderer/opengl/gbuffer.h"
#include "renderer/picture.h"
#include "renderer/scene/mesh.h"
#include "renderer/visibility/visibility.h"

namespace lumifield {

/// Positions, normals and the normals of their faces of a G-buffer as each placement's luminaire sees them, one
/// placement after the other: 4 floats each, mm, luminaire frame; all 0 for background.
struct Receivers {
  std::vector<float> p, n, face;
};
Receivers receivers_of(const GBuffer& gbuffer, const std::vector<ScenePlacement>& placements);
/// As methods take them.
std::vector<Receiver> as_receivers(const Receivers& seen);

/// What a picture leaves out of the light, for people. environment: it shows one's light. method: what computes it; of
/// shift-invariant the look-up is named.
std::string left_out(Visibility visibility, bool environment = false, const MethodSettings& method = {});

/// The lobes of those receivers, in their order; LOBE_NONE for background and diffuse surfaces. Empty when no surface
/// in sight is glossy. eye_mm: scene frame.
std::vector<GlossLobe> lobes_of(const GBuffer& gbuffer, const std::vector<Material>& materials,
                                const std::vector<ScenePlacement>& placements, const Vec3& eye_mm);

/// Diffuse reflectance, R G B, of the surface at a pixel: the G-buffer's, or without that the material's.
const float* diffuse_at(const GBuffer& gbuffer, const std::vector<Material>& materials, std::size_t pixel);

/// What each placement's receivers get of a luminaire of scale 1, one placement after the other. Spans: valid as long
/// as what they look at.
struct Received {
  std::span<const double> irradiance;
  std::size_t channels = 0;  ///< values of irradiance a receiver, 1 or 3
  std::span<const double> gloss = {};
  std::size_t gloss_channels = 0;  ///< of radiance by gloss, 0, 1 (counts for R, G and B) or 3
};

/// radiance = diffuse_at/π · Σ scale·E + Σ scale·G, E and G taken as float. `environment`: radiance of its light, R G B
/// by pixel, added; empty where there is none. Of its harmonics it may be below 0: then it takes from the luminaire's
/// light. Fills rgb and coverage of a picture of the G-buffer's size.
void shade(const GBuffer& gbuffer, const std::vector<Material>& materials,
           const std::vector<ScenePlacement>& placements, const Received& received, std::span<const float> environment,
           Picture& picture);

/// Radiance of an environment's light that surfaces reflect to the eye, R G B of the pixels begin … end − 1 of all; 0
/// for background.
void shade_by_environment(const GBuffer& gbuffer, const std::vector<Material>& materials,
                          const EnvironmentLight& environment, const Vec3& eye_mm, std::size_t begin, std::size_t end,
                          std::span<float> radiance);

}  // namespace lumifield
