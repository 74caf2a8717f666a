#pragma once

#include <cmath>

#include "renderer/methods/host_method.h"
#include "tests/support/small_luminaire.h"

namespace lumifield::test {

/// What methods that sample are run on by the thousand: coarser than small_luminaire, its supports half as wide.
inline LightField sampled_luminaire(int channels = 1, BasisKind basis = BasisKind::bell) {
  SyntheticLuminaire small = small_luminaire();
  small.basis = basis;
  small.spacing_mm = 8;
  small.pixels = 40;
  small.pixel_mm = 2;
  small.seed = 5;
  return make_luminaire(small, channels);
}

/// Receivers of it.
struct Case {
  const char* name;
  Receiver receiver;
};
inline const Vec3 towards = Vec3(0.2, -0.1, -1).normalized();
inline const Case far_away{"far away", {{40, -25, 600}, towards}};
inline const Case beyond{"beyond S", {{6, -4, 140}, towards}};
inline const Case near_s{"near S", {{3, -2, 66}, towards}};
inline const Case on_s{"on S", {{3, -2, 60}, towards}};
inline const Case between{"between the planes", {{2, 1, 25}, towards}};
inline const Case grazing{"grazing", {{6, -4, 140}, Vec3(0.97, 0.2, -0.03).normalized()}};

/// A lobe whose axis meets U at the point given, mm.
inline Look shining(const Receiver& receiver, int kind, float shape, const Vec2& at = {0, 0}) {
  const Vec3 to_light = (Vec3(at.x(), at.y(), 0) - receiver.p_mm).normalized();
  const Vec3 eye = 2 * receiver.n.dot(to_light) * receiver.n - to_light;
  const Eigen::Vector3f o = eye.cast<float>();
  Look look;
  look.lobe = {o.x(), o.y(), o.z(), shape, 0.5F, 0.5F, 0.5F, kind};
  return look;
}

/// One of the receiver's values: of the irradiance, then of the radiance by gloss.
inline double exact(const LightField& field, const Receiver& receiver, const Look& look, std::size_t value) {
  return make_host_method(field, {.method = Method::reference}).value()->light(receiver, 0, look).value()[value];
}

/// Of one value over seeds: the mean and its standard error, and the RMS error.
struct Runs {
  double mean = 0, error = 0, rms = 0;
};
inline Runs runs(const LightField& field, MethodSettings settings, const Receiver& receiver, const Look& look,
                 std::size_t value, double reference, int seeds) {
  Runs all;
  double squares = 0;
  for (int seed = 1; seed <= seeds; ++seed) {
    settings.seed = static_cast<std::uint32_t>(seed);
    const double e = make_host_method(field, settings).value()->light(receiver, 17, look).value()[value];
    all.mean += e / seeds;
    squares += e * e / seeds;
    all.rms += (e - reference) * (e - reference) / seeds;
  }
  all.error = std::sqrt(std::max(squares - all.mean * all.mean, 0.0) / (seeds - 1));
  all.rms = std::sqrt(all.rms);
  return all;
}

}  // namespace lumifield::test
