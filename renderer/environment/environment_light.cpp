#include "renderer/environment/environment_light.h"

#include "renderer/methods/lobe_sampling.h"

namespace lumifield {

namespace {

std::vector<LobePoint> points_of(const EnvironmentSettings& settings) {
  return lobe_points(PointSequence::halton, settings.samples, settings.seed, LobeDraws::glossy);
}

}  // namespace

Result<std::unique_ptr<EnvironmentLight>> EnvironmentLight::read(const std::filesystem::path& file, double scale,
                                                                 const EnvironmentSettings& settings) {
  Result<LatLong> environment = LatLong::read(file);
  if (!environment) return tl::unexpected(environment.error());
  return std::make_unique<EnvironmentLight>(std::move(*environment), scale, settings);
}

EnvironmentLight::EnvironmentLight(LatLong environment, double scale, const EnvironmentSettings& settings)
    : environment_(std::move(environment)),
      map_(environment_),
      harmonics_(environment_),
      scale_(scale),
      settings_(settings),
      points_(points_of(settings)) {}

EnvironmentLight EnvironmentLight::with(const EnvironmentSettings& settings) const {
  EnvironmentLight other = *this;
  other.settings_ = settings;
  other.points_ = points_of(settings);
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
    if (settings_.filter) {
      const double level = map_.level(1 / (settings_.samples * draw.pdf), draw.direction.z());
      const Eigen::Array4f light = map_.radiance(draw.direction, level);
      for (std::size_t c = 0; c < 3; ++c)
        sum[c] += each * draw.weight[c] * static_cast<double>(light[static_cast<Eigen::Index>(c)]);
    } else {
      const auto light = environment_.radiance(draw.direction);
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
