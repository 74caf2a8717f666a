#include "renderer/shading.h"

#include <Eigen/Core>
#include <array>
#include <numbers>

#include "renderer/bands.h"

namespace lumifield {

Receivers receivers_of(const GBuffer& gbuffer, const std::vector<ScenePlacement>& placements) {
  const std::size_t floats = gbuffer.position.size();
  Receivers receivers;
  receivers.p.resize(floats * placements.size());
  receivers.n.resize(receivers.p.size());
  for (std::size_t l = 0; l < placements.size(); ++l) {
    const Eigen::Matrix3d to_luminaire = placements[l].pose.topLeftCorner<3, 3>().transpose();
    const Vec3 origin = placements[l].pose.topRightCorner<3, 1>();
    in_bands(floats / 4, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = 4 * begin; i < 4 * end; i += 4) {
        if (gbuffer.position[i + 3] == 0) continue;
        const Eigen::Map<const Eigen::Vector3f> p(&gbuffer.position[i]), n(&gbuffer.normal[i]);
        const std::size_t out = l * floats + i;
        Eigen::Map<Eigen::Vector3f>(&receivers.p[out]) = (to_luminaire * (p.cast<double>() - origin)).cast<float>();
        Eigen::Map<Eigen::Vector3f>(&receivers.n[out]) = (to_luminaire * n.cast<double>()).cast<float>();
      }
    });
  }
  return receivers;
}

std::string left_out(Visibility visibility) {
  const std::string indirect = "light from surface to surface";
  return visibility == Visibility::none ? "shadows, and " + indirect : indirect;
}

void shade(const GBuffer& gbuffer, const std::vector<Material>& materials,
           const std::vector<ScenePlacement>& placements, std::span<const double> irradiance, std::size_t channels,
           Picture& picture) {
  const std::size_t pixels = picture.coverage.size();
  std::vector<std::array<double, 3>> reflected(materials.size());
  for (std::size_t m = 0; m < materials.size(); ++m)
    for (std::size_t c = 0; c < 3; ++c) reflected[m][c] = materials[m].diffuse[c] / std::numbers::pi;
  in_bands(pixels, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      picture.coverage[i] = gbuffer.position[4 * i + 3];
      std::array<double, 3> e{};
      if (picture.coverage[i] != 0)
        for (std::size_t l = 0; l < placements.size(); ++l)
          for (std::size_t c = 0; c < channels; ++c)
            e[c] += placements[l].scale * static_cast<float>(irradiance[(l * pixels + i) * channels + c]);
      if (channels == 1) e[1] = e[2] = e[0];
      const std::array<double, 3>& rate = reflected[static_cast<std::size_t>(gbuffer.normal[4 * i + 3])];
      for (std::size_t c = 0; c < 3; ++c) picture.rgb[3 * i + c] = static_cast<float>(rate[c] * e[c]);
    }
  });
}

}  // namespace lumifield
