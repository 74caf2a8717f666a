// The kernels of receivers that see a part of U, and shine, against their host forms in double.
#include <cmath>
#include <gtest/gtest.h>

#include "renderer/methods/device_method.h"
#include "renderer/methods/host_method.h"
#include "renderer/renderer.h"
#include "tests/support/random_looks.h"
#include "tests/support/small_luminaire.h"

namespace lumifield {
namespace {

std::vector<Receiver> receivers() {
  std::vector<Receiver> all;
  for (int k = 0; k < 200; ++k) {
    const double x = 40 * std::sin(1.3 * k), y = 30 * std::cos(2.1 * k);
    const double heights[] = {90, 140, 250, 700, 120};
    const double z = heights[k % 5];
    all.push_back({{x * z / 150, y * z / 150, z}, Vec3(0.3 * std::sin(k), 0.3 * std::cos(k), -1).normalized()});
  }
  all[7].n = {0, 0, 0};
  return all;
}

class DeviceLooks : public testing::TestWithParam<std::tuple<Method, int>> {
 protected:
  void SetUp() override {
    if (const auto found = probe_opencl(); !found) GTEST_SKIP() << found.error().message();
  }
};
INSTANTIATE_TEST_SUITE_P(All, DeviceLooks,
                         testing::Combine(testing::Values(Method::closed_form, Method::position_dependent,
                                                          Method::position_dependent_printed, Method::uniform_box,
                                                          Method::precomputed_lights, Method::filtered_brdf,
                                                          Method::mis, Method::far_field, Method::shift_invariant),
                                          testing::Values(1, 3)),
                         [](const auto& each) {
                           std::string name(to_string(std::get<0>(each.param)));
                           std::ranges::replace(name, '-', '_');
                           return name + std::to_string(std::get<1>(each.param));
                         });

/// Rounding of a lobe in float, of its peak; of draws near a pixel's or a tile's edge rounding moves a few beside.
TEST_P(DeviceLooks, AreThoseOfTheHostForm) {
  const auto [which, channels] = GetParam();
  for (const auto& [basis, weighing] :
       {std::pair(BasisKind::bell, ShadowWeighing::mean), {BasisKind::bspline2, ShadowWeighing::tile}}) {
    SyntheticLuminaire small = test::small_luminaire();
    small.basis = basis;
    small.seed = 5;
    const LightField field = make_luminaire(small, channels);
    const std::vector<Receiver> at = receivers();
    const Appearance appearance{test::random_lobes(at, basis != BasisKind::bell),
                                test::random_visibility(field.geometry().sampling, at.size(), weighing)};
    const MethodSettings settings{.method = which, .samples = which == Method::precomputed_lights ? 3000.0 : 60.0};
    const auto host = make_host_method(field, settings).value();
    const auto device = make_device_method(field.geometry(), settings).value();
    ASSERT_TRUE(device->set_cells(field));
    const Status set = device->set_receivers(at, appearance);
    ASSERT_TRUE(set) << set.error().message();
    const auto done = device->evaluate(HUGE_VAL);
    ASSERT_TRUE(done) << done.error().message();
    std::vector<double> e, gloss;
    ASSERT_TRUE(device->read(e));
    ASSERT_TRUE(device->read_gloss(gloss));
    const auto values = static_cast<std::size_t>(channels), outs = device->gloss_channels();
    ASSERT_EQ(outs, basis == BasisKind::bell ? values : 3U);
    ASSERT_EQ(gloss.size(), outs * at.size());

    double squares = 0;
    for (const double v : e) squares += v * v;
    const double rms = std::sqrt(squares / static_cast<double>(e.size()));
    ASSERT_GT(rms, 0);
    int strays = 0;
    double reflected = 0;
    for (std::size_t k = 0; k < at.size(); ++k) {
      const GlossLobe& lobe = appearance.gloss[k];
      const double shape = lobe.shape;
      const double peak = lobe.kind == LOBE_PHONG ? (shape + 2) / 6 : 1 / (4 * shape * shape);
      const std::vector<double> wanted = at[k].n == Vec3(0, 0, 0)
                                             ? std::vector<double>(values, 0.0)
                                             : host->light(at[k], std::uint32_t(k), appearance.look(k)).value();
      for (std::size_t c = 0; c < values; ++c) strays += std::abs(e[k * values + c] - wanted[c]) > 1e-5 * rms;
      const std::size_t given = wanted.size() - values;
      for (std::size_t c = 0; given > 0 && c < outs; ++c) {
        strays += std::abs(gloss[k * outs + c] - wanted[values + c % given]) > 3e-5 * rms * std::max(1.0, peak);
        reflected += wanted[values + c % given];
      }
    }
    EXPECT_GT(reflected, 0);
    const bool draws = which != Method::closed_form && which != Method::far_field && which != Method::shift_invariant;
    EXPECT_LE(strays, draws ? 6 * channels : 0) << to_string(basis);
  }
}

TEST(DeviceAppearance, OfOtherReceiversIsRefused) {
  if (const auto found = probe_opencl(); !found) GTEST_SKIP() << found.error().message();
  const LightField field = make_luminaire(test::small_luminaire(), 1);
  const std::vector<Receiver> at = receivers();
  Appearance appearance{test::random_lobes(at, false),
                        test::random_visibility(field.geometry().sampling, at.size(), ShadowWeighing::tile)};
  for (const Method which : {Method::closed_form, Method::uniform_box, Method::reference}) {
    const auto device = make_device_method(field.geometry(), {.method = which}).value();
    EXPECT_TRUE(device->set_receivers(at, appearance));
    EXPECT_FALSE(device->set_receivers(std::span(at).first(10), appearance));
    Appearance other = appearance;
    other.visible.grid.columns += 1;
    EXPECT_FALSE(device->set_receivers(at, other));
    other = appearance;
    other.gloss[3].shape = NAN;
    const Status refused = device->set_receivers(at, other);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().where, "receiver 3");
  }
}

}  // namespace
}  // namespace lumifield
