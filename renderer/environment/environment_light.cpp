#include "renderer/environment/environment_light.h"

#include <cstdio>
#include <numbers>

#include "renderer/methods/lobe_sampling.h"

namespace lumifield {

namespace {

std::vector<LobePoint> points_of(const EnvironmentSettings& settings) {
  return lobe_points(PointSequence::halton, settings.samples, settings.seed, LobeDraws::glossy);
}

std::vector<std::string> notes_of(const LatLong& environment, const DualParaboloid* map,
                                  const std::filesystem::path& file) {
  std::vector<std::string> notes;
  if (!environment.note().empty()) notes.push_back(file.string() + ": " + environment.note());
  const double pixel = 2 * std::numbers::pi / environment.width_px();
  if (map && map->widest_texel() > pixel) {
    char text[120];
    std::snprintf(text, sizeof text, ": its pixels span %.2f°, but gloss reflects it in texels of up to %.2f°",
                  pixel * 180 / std::numbers::pi, map->widest_texel() * 180 / std::numbers::pi);
    notes.push_back(file.string() + text);
  }
  return notes;
}

}  // namespace

Result<std::unique_ptr<EnvironmentLight>> EnvironmentLight::read(const std::filesystem::path& file, double scale,
                                                                 const EnvironmentSettings& settings,
                                                                 const std::stop_token& stop) {
  const Result<LatLong> environment = LatLong::read(file);
  if (!environment) return tl::unexpected(environment.error());
  std::shared_ptr<const DualParaboloid> map;
  if (settings.filter) {
    auto made = DualParaboloid::make(*environment, stop);
    if (!made) return tl::unexpected(Error{"stopped before its map was made", file.string(), {}, ErrorKind::stopped});
    map = std::make_shared<const DualParaboloid>(std::move(*made));
  }
  std::unique_ptr<EnvironmentLight> light(new EnvironmentLight(*environment, std::move(map), scale, settings));
  light->notes_ = notes_of(*environment, light->map_.get(), file);
  return light;
}

EnvironmentLight::EnvironmentLight(const LatLong& environment, double scale, const EnvironmentSettings& settings)
    : EnvironmentLight(environment, settings.filter ? std::make_shared<const DualParaboloid>(environment) : nullptr,
                       scale, settings) {}

EnvironmentLight::EnvironmentLight(const LatLong& environment, std::shared_ptr<const DualParaboloid> map, double scale,
                                   const EnvironmentSettings& settings)
    : environment_(map ? std::nullopt : std::optional(environment)),
      map_(std::move(map)),
      harmonics_(environment),
      scale_(scale),
      settings_(settings),
      points_(points_of(settings)) {}

EnvironmentLight EnvironmentLight::with(int samples, std::uint32_t seed) const {
  EnvironmentLight other = *this;
  other.settings_.samples = samples;
  other.settings_.seed = seed;
  other.points_ = points_of(other.settings_);
  return other;
}

std::array<double, 3> EnvironmentLight::irradiance(const Vec3& n) const {
  auto e = harmonics_.irradiance(n);
  for (double& each : e) each *= scale_;
  return e;
}

std::array<double, 3> EnvironmentLight::gloss(const GlossLobe& lobe, const Vec3& n) const {
  std::array<double, 3> sum{};
  const LobeDistribution draws(lobe, n);
  if (lobe.kind == LOBE_NONE || !draws.shines()) return sum;
  const double each = scale_ / settings_.samples;
  for (const LobePoint& xi : points_) {
    const LobeDraw draw = draws.sample(xi);
    if (!(draw.direction.dot(n) > 0)) continue;
    if (map_) {
      const double level = map_->level(1 / (settings_.samples * draw.pdf), draw.direction.z());
      const Eigen::Array4f light = map_->radiance(draw.direction, level);
      for (std::size_t c = 0; c < 3; ++c)
        sum[c] += each * draw.weight[c] * static_cast<double>(light[static_cast<Eigen::Index>(c)]);
    } else {
      const auto light = environment_->radiance(draw.direction);
      for (std::size_t c = 0; c < 3; ++c) sum[c] += each * draw.weight[c] * light[c];
    }
  }
  return sum;
}

std::vector<LobePoint> environment_reference_points(int samples) {
  return lobe_points(PointSequence::halton, samples, 2, LobeDraws::diffuse);
}

std::array<double, 3> environment_reference(const LatLong& environment, const GlossLobe& lobe, const Vec3& n,
                                            std::span<const LobePoint> points) {
  std::array<double, 3> sum{};
  const LobeDistribution draws(lobe, n);
  if (!draws.shines()) return sum;
  const auto samples = static_cast<double>(points.size());
  for (const LobePoint& xi : points) {
    const LobeDraw draw = draws.sample(xi);
    const auto light = environment.radiance(draw.direction);
    for (std::size_t c = 0; c < 3; ++c) sum[c] += draw.weight[c] * light[c] / samples;
  }
  return sum;
}

}  // namespace lumifield
