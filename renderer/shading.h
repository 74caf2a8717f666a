#pragma once

#include <span>
#include <vector>

#include "luminaire/scene.h"
#include "renderer/opengl/gbuffer.h"
#include "renderer/picture.h"
#include "renderer/scene/mesh.h"
#include "renderer/visibility/visibility.h"

namespace lumifield {

/// Positions and normals of a G-buffer as each placement's luminaire sees them, one placement after the other: 4 floats
/// each, mm, luminaire frame; all 0 for background.
struct Receivers {
  std::vector<float> p, n;
};
Receivers receivers_of(const GBuffer& gbuffer, const std::vector<ScenePlacement>& placements);

/// What a picture leaves out of the light, for people.
std::string left_out(Visibility visibility);

/// radiance = reflectance/π · Σ scale·E, with E of each placement's receivers in turn, `channels` (1 or 3) values each,
/// taken as float. Fills rgb and coverage of a picture of the G-buffer's size.
void shade(const GBuffer& gbuffer, const std::vector<Material>& materials,
           const std::vector<ScenePlacement>& placements, std::span<const double> irradiance, std::size_t channels,
           Picture& picture);

}  // namespace lumifield
