#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "luminaire/geometry.h"
#include "renderer/methods/gloss_shared.h"
#include "renderer/methods/lobe_sampling_shared.h"
#include "renderer/sampling/sequence.h"

namespace lumifield {

/// A direction towards light, of unit length, its density over solid angle in 1/sr, and f·max(0, n·ω)/pdf in R, G, B:
/// what the light from there is multiplied by. 0 below the surface.
struct LobeDraw {
  Vec3 direction{0, 0, 1};
  double pdf = 0;
  std::array<double, 3> weight{};
};

/// The directions that a surface reflects light from. A diffuse one: density cosθ/π, weight π|n|, as of f = 1: the
/// irradiance. Phong: (n + 1)/(2π) cosⁿα about the mirrored eye. GGX: normals by the density of those the eye sees,
/// mirrored, G₁ D/(4 cosθ_o) (Heitz 2018): its weight is F G₂/G₁, which no grazing angle makes large. All in double.
/// Value type, safe from any thread. renderer/methods/lobe_sampling.clh draws the same.
class LobeDistribution {
 public:
  /// lobe.kind LOBE_NONE: diffuse. n: of about unit length, in the frame of the lobe's eye.
  LobeDistribution(const GlossLobe& lobe, const Vec3& n);

  /// The eye is above the surface, or there is none.
  bool shines() const { return no_ > 0; }
  LobeDraw sample(const LobePoint& xi) const;
  /// Density of what sample gives, 1/sr; a part of it may be below the surface. direction: of unit length.
  double pdf(const Vec3& direction) const;
  /// f·max(0, n·ω)/pdf there, LobeDraw::weight.
  std::array<double, 3> weight(const Vec3& direction) const;
  /// What sample takes to `direction`, which has a density: x and y of the unit square.
  Vec2 invert(const Vec3& direction) const;
  /// The mirrored eye, or the normal: about where most are drawn, within an angle of this width in radians.
  const Vec3& axis() const { return axis_; }
  double width() const;
  double angle_from_axis(const Vec3& direction) const;

 private:
  Vec3 half_vector(const LobePoint& xi) const;

  GlossLobe lobe_;
  Vec3 n_, normal_, eye_;    ///< as given; of unit length
  Vec3 axis_;                ///< about which Phong and diffuse draw
  Vec3 across_, along_;      ///< with it, or of GGX with the normal, a frame
  double no_, spread_;       ///< n·o; √(α² + (1 − α²) (n·o)²)
  Vec3 squeezed_, t1_, t2_;  ///< of GGX, in the frame, the eye as it is when the ellipsoid of normals is a sphere
};

/// n points of a run, for one kind of draw. Hammersley's ((i + x₀)/n, Φ₂(i) + y₀), x₀ and y₀ by the seed, so that each
/// is uniform over the seeds and none is 0; or, of the twister, a table of independent ones of which each receiver
/// takes n from first_point on.
enum class LobeDraws { diffuse = 1, glossy = 2 };
std::vector<LobePoint> lobe_points(PointSequence sequence, int n, std::uint32_t seed, LobeDraws draws);
/// How many they are.
std::size_t lobe_table(PointSequence sequence, int n);
/// Of all seeds the same, and so many more than n that their mean stands for an integral over the samples' density: 16
/// n, at least 4096 and at most 65,536, but never fewer than n.
std::vector<LobePoint> judging_points(int n);
std::size_t first_point(PointSequence sequence, std::size_t points, std::uint32_t receiver, std::uint32_t seed,
                        LobeDraws draws);

/// All points of a receiver turned about the lobe by an angle of its own (Cranley, Patterson 1976, in φ): what they
/// miss of the light differs from receiver to receiver, as noise, where the same points for all leave patches.
struct LobeTurn {
  double cosine, sine;
};
LobeTurn lobe_turn(std::uint32_t receiver, std::uint32_t seed, LobeDraws draws);
LobePoint turned(const LobePoint& point, const LobeTurn& turn);

/// Two directions that are a right-handed frame with a third of unit length (Duff et al. 2017).
void frame_about(const Vec3& axis, Vec3& across, Vec3& along);

}  // namespace lumifield
