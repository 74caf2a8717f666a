#include "renderer/shading.h"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <numbers>

#include "renderer/bands.h"

namespace lumifield {

Receivers receivers_of(const GBuffer& gbuffer, const std::vector<ScenePlacement>& placements) {
  const std::size_t floats = gbuffer.position.size();
  Receivers receivers;
  receivers.p.resize(floats * placements.size());
  receivers.n.resize(receivers.p.size());
  receivers.face.resize(receivers.p.size());
  for (std::size_t l = 0; l < placements.size(); ++l) {
    const Eigen::Matrix3d to_luminaire = placements[l].pose.topLeftCorner<3, 3>().transpose();
    const Vec3 origin = placements[l].pose.topRightCorner<3, 1>();
    in_bands(floats / 4, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = 4 * begin; i < 4 * end; i += 4) {
        if (gbuffer.position[i + 3] == 0) continue;
        const Eigen::Map<const Eigen::Vector3f> p(&gbuffer.position[i]), n(&gbuffer.normal[i]), face(&gbuffer.face[i]);
        const std::size_t out = l * floats + i;
        Eigen::Map<Eigen::Vector3f>(&receivers.p[out]) = (to_luminaire * (p.cast<double>() - origin)).cast<float>();
        Eigen::Map<Eigen::Vector3f>(&receivers.n[out]) = (to_luminaire * n.cast<double>()).cast<float>();
        Eigen::Map<Eigen::Vector3f>(&receivers.face[out]) = (to_luminaire * face.cast<double>()).cast<float>();
      }
    });
  }
  return receivers;
}

std::vector<Receiver> as_receivers(const Receivers& seen) {
  std::vector<Receiver> receivers(seen.p.size() / 4);
  in_bands(receivers.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k)
      receivers[k] = {{seen.p[4 * k], seen.p[4 * k + 1], seen.p[4 * k + 2]},
                      {seen.n[4 * k], seen.n[4 * k + 1], seen.n[4 * k + 2]}};
  });
  return receivers;
}

std::string left_out(Visibility visibility, bool environment, const MethodSettings& method) {
  std::string text = visibility == Visibility::none ? "shadows, " : "";
  if (environment)
    text +=
        "the environment behind the scene, what hides the environment, more than nine harmonics of its diffuse light "
        "(off by −4 to +9 % of a small source's, below 0 about 120° from it), ";
  text += (text.empty() ? "" : "and ") + std::string("light from surface to surface");
  if (method.method == Method::shift_invariant)
    text += "; where within a cell its light comes from (shift-invariant, " +
            std::string(to_string(method.spots.look_up)) + ")";
  return text;
}

namespace {

GlossLobe lobe_of(const Material& m, const Vec3& to_eye) {
  const Eigen::Vector3f eye = to_eye.cast<float>();
  return {eye.x(), eye.y(), eye.z(), m.shape, m.specular[0], m.specular[1], m.specular[2], m.lobe};
}

}  // namespace

std::vector<GlossLobe> lobes_of(const GBuffer& gbuffer, const std::vector<Material>& materials,
                                const std::vector<ScenePlacement>& placements, const Vec3& eye_mm) {
  const std::size_t pixels = gbuffer.position.size() / 4;
  const auto material_at = [&](std::size_t k) -> const Material& {
    return materials[static_cast<std::size_t>(gbuffer.normal[4 * k + 3])];
  };
  const auto glossy = [&](std::size_t k) {
    return gbuffer.position[4 * k + 3] != 0 && material_at(k).lobe != LOBE_NONE;
  };
  std::size_t first = 0;
  while (first < pixels && !glossy(first)) ++first;
  if (first == pixels) return {};
  std::vector<GlossLobe> lobes(pixels * placements.size());
  for (std::size_t l = 0; l < placements.size(); ++l) {
    const Eigen::Matrix3d to_luminaire = placements[l].pose.topLeftCorner<3, 3>().transpose();
    in_bands(pixels, [&](std::size_t begin, std::size_t end) {
      for (std::size_t k = std::max(begin, first); k < end; ++k) {
        if (!glossy(k)) continue;
        const Eigen::Map<const Eigen::Vector3f> p(&gbuffer.position[4 * k]);
        lobes[l * pixels + k] = lobe_of(material_at(k), (to_luminaire * (eye_mm - p.cast<double>())).normalized());
      }
    });
  }
  return lobes;
}

const float* diffuse_at(const GBuffer& gbuffer, const std::vector<Material>& materials, std::size_t pixel) {
  return gbuffer.reflectance.empty() ? materials[static_cast<std::size_t>(gbuffer.normal[4 * pixel + 3])].diffuse.data()
                                     : &gbuffer.reflectance[4 * pixel];
}

namespace {

/// Σ scale·values over the placements, in R, G and B.
std::array<double, 3> sum_of(std::span<const double> values, std::size_t channels, std::size_t pixel,
                             std::size_t pixels, const std::vector<ScenePlacement>& placements) {
  std::array<double, 3> sum{};
  for (std::size_t l = 0; l < placements.size(); ++l)
    for (std::size_t c = 0; c < channels; ++c)
      sum[c] += placements[l].scale * static_cast<float>(values[(l * pixels + pixel) * channels + c]);
  if (channels == 1) sum[1] = sum[2] = sum[0];
  return sum;
}

}  // namespace

void shade(const GBuffer& gbuffer, const std::vector<Material>& materials,
           const std::vector<ScenePlacement>& placements, const Received& received, std::span<const float> environment,
           Picture& picture) {
  const std::size_t pixels = picture.coverage.size();
  in_bands(pixels, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      picture.coverage[i] = gbuffer.position[4 * i + 3];
      std::array<double, 3> e{}, g{};
      if (picture.coverage[i] != 0) {
        e = sum_of(received.irradiance, received.channels, i, pixels, placements);
        g = sum_of(received.gloss, received.gloss_channels, i, pixels, placements);
      }
      const float* diffuse = diffuse_at(gbuffer, materials, i);
      for (std::size_t c = 0; c < 3; ++c) {
        const double around = environment.empty() ? 0 : environment[3 * i + c];
        picture.rgb[3 * i + c] = static_cast<float>(diffuse[c] * std::numbers::inv_pi * e[c] + g[c] + around);
      }
    }
  });
}

void shade_by_environment(const GBuffer& gbuffer, const std::vector<Material>& materials,
                          const EnvironmentLight& environment, const Vec3& eye_mm, std::size_t begin, std::size_t end,
                          std::span<float> radiance) {
  in_bands(end - begin, [&](std::size_t from, std::size_t to) {
    for (std::size_t i = begin + from; i < begin + to; ++i) {
      if (gbuffer.position[4 * i + 3] == 0) {
        for (std::size_t c = 0; c < 3; ++c) radiance[3 * i + c] = 0;
        continue;
      }
      const Vec3 p = Eigen::Map<const Eigen::Vector3f>(&gbuffer.position[4 * i]).cast<double>();
      const Vec3 n = Eigen::Map<const Eigen::Vector3f>(&gbuffer.normal[4 * i]).cast<double>();
      const Material& material = materials[static_cast<std::size_t>(gbuffer.normal[4 * i + 3])];
      const float* diffuse = diffuse_at(gbuffer, materials, i);
      const auto e = environment.irradiance(n);
      std::array<double, 3> g{};
      if (material.lobe != LOBE_NONE) g = environment.gloss(lobe_of(material, (eye_mm - p).normalized()), n);
      for (std::size_t c = 0; c < 3; ++c)
        radiance[3 * i + c] = static_cast<float>(diffuse[c] * std::numbers::inv_pi * e[c] + g[c]);
    }
  });
}

}  // namespace lumifield
