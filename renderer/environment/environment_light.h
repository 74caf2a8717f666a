#pragma once

#include <array>
#include <filesystem>
#include <memory>
#include <span>
#include <vector>

#include "renderer/environment/dual_paraboloid.h"
#include "renderer/environment/spherical_harmonics.h"
#include "renderer/methods/gloss_shared.h"
#include "renderer/methods/lobe_sampling_shared.h"

namespace lumifield {

struct EnvironmentSettings {
  int samples = 40;    ///< N of a lobe
  bool filter = true;  ///< each is looked up at its level of detail; else on the image's own pixels
  std::uint32_t seed = 1;
};

/// The light of an environment that surfaces reflect, as if nothing of the scene stood before it: irradiance by
/// spherical harmonics, radiance by gloss by N samples of the lobe. In units of the environment's image times `scale`,
/// scene frame. Immutable, safe from any thread.
class EnvironmentLight {
 public:
  /// Errors: those of LatLong::read.
  static Result<std::unique_ptr<EnvironmentLight>> read(const std::filesystem::path& file, double scale,
                                                        const EnvironmentSettings& settings = {});
  EnvironmentLight(LatLong environment, double scale, const EnvironmentSettings& settings = {});

  /// The same light by other samples.
  EnvironmentLight with(const EnvironmentSettings& settings) const;

  std::array<double, 3> irradiance(const Vec3& n) const;
  /// Towards the lobe's eye, all in the scene frame.
  std::array<double, 3> gloss(const GlossLobe& lobe, const Vec3& n) const;

 private:
  LatLong environment_;
  DualParaboloid map_;
  IrradianceHarmonics harmonics_;
  double scale_;
  EnvironmentSettings settings_;
  std::vector<LobePoint> points_;
};

/// What the harmonics and the filter are judged by: the mean of unfiltered samples, of the diffuse part (kind
/// LOBE_NONE: irradiance) or of the lobe, in double, by points made once for all receivers. Units of the image.
std::vector<LobePoint> environment_reference_points(int samples);
std::array<double, 3> environment_reference(const LatLong& environment, const GlossLobe& lobe, const Vec3& n,
                                            std::span<const LobePoint> points);

}  // namespace lumifield
