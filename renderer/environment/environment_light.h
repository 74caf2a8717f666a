#pragma once

#include <array>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <stop_token>
#include <string>
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
/// scene frame. Of the image only what is looked up is kept: the map where samples are filtered, else the pixels;
/// copies share it. Value type, immutable, safe from any thread.
class EnvironmentLight {
 public:
  /// Errors: those of LatLong::read; ErrorKind::stopped, where `stop` asks for it while the map is made.
  static Result<std::unique_ptr<EnvironmentLight>> read(const std::filesystem::path& file, double scale,
                                                        const EnvironmentSettings& settings = {},
                                                        const std::stop_token& stop = {});
  EnvironmentLight(const LatLong& environment, double scale, const EnvironmentSettings& settings = {});

  /// The same light, filtered or not as it is, by other samples.
  EnvironmentLight with(int samples, std::uint32_t seed) const;

  /// What it does not show of its file, and why, for people.
  const std::vector<std::string>& notes() const { return notes_; }
  std::array<double, 3> irradiance(const Vec3& n) const;
  /// Towards the lobe's eye, all in the scene frame.
  std::array<double, 3> gloss(const GlossLobe& lobe, const Vec3& n) const;

 private:
  EnvironmentLight(const LatLong& environment, std::shared_ptr<const DualParaboloid> map, double scale,
                   const EnvironmentSettings& settings);

  std::optional<LatLong> environment_;         ///< where samples are not filtered
  std::shared_ptr<const DualParaboloid> map_;  ///< where they are
  IrradianceHarmonics harmonics_;
  double scale_;
  EnvironmentSettings settings_;
  std::vector<LobePoint> points_;
  std::vector<std::string> notes_;
};

/// What the harmonics and the filter are judged by: the mean of unfiltered samples, of the diffuse part (kind
/// LOBE_NONE: irradiance) or of the lobe, in double, by points made once for all receivers. Units of the image.
std::vector<LobePoint> environment_reference_points(int samples);
std::array<double, 3> environment_reference(const LatLong& environment, const GlossLobe& lobe, const Vec3& n,
                                            std::span<const LobePoint> points);

}  // namespace lumifield
