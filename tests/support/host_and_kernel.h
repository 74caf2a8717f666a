#pragma once

#include <cmath>
#include <functional>
#include <gtest/gtest.h>

#include "renderer/methods/device_method.h"
#include "renderer/methods/host_method.h"
#include "renderer/renderer.h"
#include "tests/support/random_looks.h"
#include "tests/support/small_luminaire.h"

namespace lumifield::test {

/// Before small_luminaire, beyond S, on it, between the planes and behind U; the eighth has no surface.
inline std::vector<Receiver> receivers_at_all_heights(int count) {
  std::vector<Receiver> all;
  for (int k = 0; k < count; ++k) {
    const double x = 40 * std::sin(1.3 * k), y = 30 * std::cos(2.1 * k);
    const double heights[] = {90, 140, 250, 700, 62, 60, 59, 35, 5, -4};
    const double z = heights[k % 10];
    all.push_back({{x * z / 150, y * z / 150, z}, Vec3(0.3 * std::sin(k), 0.3 * std::cos(k), -1).normalized()});
  }
  all[7].n = {0, 0, 0};
  return all;
}

inline auto host_and_kernel_cases() {
  return testing::Combine(testing::Values(BasisKind::box, BasisKind::tent, BasisKind::bell, BasisKind::bspline2),
                          testing::Values(1, 3), testing::Bool(),
                          testing::Values(PointSequence::halton, PointSequence::twister));
}

/// Of a basis, so many channels, filtered or not, by a sequence.
class HostAndKernel : public testing::TestWithParam<std::tuple<BasisKind, int, bool, PointSequence>> {
 protected:
  void SetUp() override {
    if (const auto found = probe_opencl(); !found) GTEST_SKIP() << found.error().message();
  }

  /// How far a kernel's value may be from its host form's, of that, and how many per channel may be further: those of
  /// samples that rounding puts into another pixel.
  struct Allowed {
    double irradiance, gloss;
    int strays;
  };
  using Lobes = std::function<std::vector<GlossLobe>(const std::vector<Receiver>& at, bool coloured)>;
  /// By the parameters, plain and with looks.
  void expect_as_host(Method method, const std::vector<Receiver>& at, const Lobes& lobes, const Allowed& allowed) {
    const auto [basis, channels, filter, sequence] = GetParam();
    SyntheticLuminaire small = small_luminaire();
    small.basis = basis;
    small.seed = 5;
    const LightField field = make_luminaire(small, channels);
    const MethodSettings settings{.method = method, .samples = 40, .seed = 3, .sequence = sequence, .filter = filter};
    const auto host = make_host_method(field, settings).value();
    const auto device = make_device_method(field.geometry(), settings).value();
    ASSERT_TRUE(device->set_cells(field));
    for (const bool looks : {false, true}) {
      const auto weighing = basis == BasisKind::tent ? ShadowWeighing::mean : ShadowWeighing::tile;
      Appearance appearance;
      if (looks)
        appearance = {lobes(at, basis == BasisKind::bell),
                      random_visibility(field.geometry().sampling, at.size(), weighing)};
      ASSERT_TRUE(device->set_receivers(at, appearance));
      ASSERT_TRUE(device->evaluate(HUGE_VAL).value());
      std::vector<double> e, gloss;
      ASSERT_TRUE(device->read(e));
      ASSERT_TRUE(device->read_gloss(gloss));
      const auto values = static_cast<std::size_t>(channels), outs = device->gloss_channels();
      int strays = 0;
      double all = 0, shone = 0;
      for (std::size_t k = 0; k < at.size(); ++k) {
        const std::vector<double> wanted = at[k].n == Vec3(0, 0, 0)
                                               ? std::vector<double>(values, 0.0)
                                               : host->light(at[k], std::uint32_t(k), appearance.look(k)).value();
        const auto compare = [&](double got, double want, double share) {
          EXPECT_TRUE(std::isfinite(got));
          strays += std::abs(got - want) > share * std::abs(want) + 1e-7;
        };
        for (std::size_t c = 0; c < values; ++c)
          compare(e[k * values + c], wanted[c], allowed.irradiance), all += wanted[c];
        const std::size_t given = wanted.size() - values;
        for (std::size_t c = 0; given > 0 && c < outs; ++c)
          compare(gloss[k * outs + c], wanted[values + c % given], allowed.gloss), shone += wanted[values + c % given];
      }
      EXPECT_GT(all, 0);
      EXPECT_EQ(shone > 0, looks);
      EXPECT_LE(strays, allowed.strays * channels);
    }
  }
};

}  // namespace lumifield::test
