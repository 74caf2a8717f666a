#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <stop_token>
#include <vector>

#include "renderer/environment/lat_long.h"

namespace lumifield {

/// An environment as two square images, one for each sign of z, with levels of detail: the dual paraboloid mapping
/// scaled by b = 1.2, so that each image shows what is beyond its own half too and levels blend across the seam
/// (Colbert, Křivánek, GPU Gems 3, ch. 20.4.1),
///
///     s = ½ + x/(2 b (1 + |z|)),   t = ½ + y/(2 b (1 + |z|)),   dω = 4 b² (1 + |z|)² ds dt.
///
/// Texels of level 0 are no larger than the pixels they are made of, and the mean of these, unless that takes more than
/// largest_side of them: of images wider than 2681 pixels they are larger, 0.13° at most. Those of the other levels are
/// means over solid angle. Value type, immutable, safe from any thread.
class DualParaboloid {
 public:
  static constexpr double b = 1.2;
  static constexpr double overlap = 0.5;
  /// With its levels such a map takes 179 MB; one of twice the side took 716.
  static constexpr int largest_side = 2048;

  explicit DualParaboloid(const LatLong& environment);
  /// Made on two threads: of an image 4096 pixels wide in a second. Empty where `stop` asks to stop before it is made.
  static std::optional<DualParaboloid> make(const LatLong& environment, const std::stop_token& stop);

  /// Texels of a side of level 0, a power of two.
  int side_px() const { return side_; }
  /// What a side of the widest texels of level 0 spans, in the middle of an image, radians.
  double widest_texel() const { return 4 * b / side_; }
  int levels() const { return static_cast<int>(halves_[0].size()); }
  /// Ω_p of level 0 about a direction of unit length, sr.
  double texel_solid_angle(double z) const;
  /// The level that a sample of solid angle Ω_s is looked up at: max(0, ½ log2(Ω_s/Ω_p)) + overlap. The chapter adds 1
  /// (Sec. 20.4). Of a level's texels a look-up spreads over two an axis anyway, so half of that is enough: with 1 the
  /// light of a small lamp is spread so far that plain samples are nearer (Lab ΔE of Phong's lobe of exponent 50).
  double level(double solid_angle, double z) const;
  /// R, G, B and 0, linear between texels and levels. direction: of unit length.
  Eigen::Array4f radiance(const Vec3& direction, double level) const;

 private:
  struct Level {
    int side_px;
    std::vector<Eigen::Array4f> texels;  ///< R, G, B, 0
    Eigen::Array4f at(float s, float t) const;
  };
  DualParaboloid() = default;
  void fill(const LatLong& environment, int points, std::size_t row, std::size_t column);
  std::vector<float> solid_angles() const;
  void add_level(std::vector<float>& solid_angle);

  int side_ = 0;
  std::array<std::vector<Level>, 2> halves_;  ///< of z ≥ 0, of z < 0
};

}  // namespace lumifield
