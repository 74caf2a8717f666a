// The kernels of the sampling methods against their host forms in double: the same draws, so the same irradiance but
// for the few draws that rounding puts into another pixel.
#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>

#include "renderer/methods/device_method.h"
#include "renderer/methods/host_method.h"
#include "renderer/methods/image_sampler_device.h"
#include "renderer/methods/position_dependent_printed.h"
#include "renderer/opencl/device.h"
#include "renderer/renderer.h"
#include "renderer/study/synthetic_luminaire.h"
#include "tests/support/kernel_layout.h"
#include "tests/support/small_luminaire.h"

namespace lumifield {
namespace {

class DeviceMethods : public testing::Test {
 protected:
  void SetUp() override {
    if (const auto found = probe_opencl(); !found) GTEST_SKIP() << found.error().message();
  }
};

LightField small_luminaire(BasisKind basis, int channels) {
  SyntheticLuminaire small = test::small_luminaire();
  small.basis = basis;
  small.seed = 5;
  return make_luminaire(small, channels);
}

std::vector<Receiver> receivers(bool before_s) {
  std::vector<Receiver> all;
  for (int k = 0; k < 300; ++k) {
    const double x = 40 * std::sin(1.3 * k), y = 30 * std::cos(2.1 * k);
    const double heights[] = {90, 140, 250, 700, 62, 60, 59, 35, 5, -4};
    const double z = heights[k % (before_s ? 10 : 4)];
    all.push_back(
        {{x * z / 150, y * z / 150, z}, Vec3(0.3 * std::sin(k), 0.3 * std::cos(k), k % 11 == 5 ? 1 : -1).normalized()});
  }
  all[7].n = {0, 0, 0};
  return all;
}

struct Difference {
  double rms = 0;   ///< of those not far off, relative to the RMS of the host's values
  int far_off = 0;  ///< values off by more than 1e-5 of the host's RMS
};
/// Rounding of float in τ and in a weight, a few 2⁻²⁴.
constexpr double rounding = 1e-6;
/// Of 18,000 draws over supports of 30 columns half a step of a float cdf at each moves 0.02 to the pixel beside: more
/// than 2 by chance once in a million.
constexpr int strays = 2;

Difference compare(const LightField& field, const MethodSettings& settings, const std::vector<Receiver>& at) {
  const auto host = make_host_method(field, settings).value();
  const auto device = make_device_method(field.geometry(), settings).value();
  EXPECT_TRUE(device->set_cells(field));
  EXPECT_TRUE(device->set_receivers(at));
  EXPECT_EQ(device->evaluate(HUGE_VAL).value(), true);
  std::vector<double> got;
  EXPECT_TRUE(device->read(got));
  const std::size_t channels = field.geometry().channels.size();
  std::vector<double> wanted;
  for (std::size_t k = 0; k < at.size(); ++k)
    for (const double e : at[k].n == Vec3(0, 0, 0) ? std::vector<double>(channels, 0.0)
                                                   : host->irradiance(at[k], std::uint32_t(k)).value())
      wanted.push_back(e);
  double squares = 0, all = 0;
  for (const double e : wanted) all += e * e;
  Difference difference;
  for (std::size_t k = 0; k < wanted.size(); ++k) {
    EXPECT_TRUE(std::isfinite(got[k]));
    if (std::abs(got[k] - wanted[k]) > 1e-5 * std::sqrt(all / double(wanted.size())))
      ++difference.far_off;
    else
      squares += std::pow(got[k] - wanted[k], 2);
  }
  difference.rms = std::sqrt(squares / all);
  return difference;
}

TEST_F(DeviceMethods, DrawAsTheirHostFormsDo) {
  for (const BasisKind basis : {BasisKind::box, BasisKind::tent, BasisKind::bell, BasisKind::bspline2})
    for (const int channels : {1, 3}) {
      const LightField field = small_luminaire(basis, channels);
      for (const Method method : {Method::position_dependent, Method::uniform_box}) {
        const Difference d = compare(field, {.method = method, .samples = 60}, receivers(true));
        EXPECT_LT(d.rms, rounding) << to_string(method) << ' ' << to_string(basis) << ' ' << channels;
        EXPECT_LE(d.far_off, strays * channels) << to_string(method) << ' ' << to_string(basis) << ' ' << channels;
      }
      const Difference printed =
          compare(field, {.method = Method::position_dependent_printed, .samples = 60}, receivers(false));
      EXPECT_LT(printed.rms, rounding) << to_string(basis) << ' ' << channels;
      EXPECT_LE(printed.far_off, strays * channels);
    }
}

TEST_F(DeviceMethods, AsPrintedAgreesWhereASupportIsNarrowAndWhereReceiversAreFar) {
  const LightField field = small_luminaire(BasisKind::bell, 1);
  // Supports of 1.1 thousandths of a pixel just beyond S, the least that the method takes; and 100 m away.
  std::vector<Receiver> at;
  for (int k = 0; k < 40; ++k)
    at.push_back({{9.3 * std::sin(k) - 0.37, 7.1 * std::cos(2 * k), 60 / (1 - 1.1 * printed_least_span_px / 32)},
                  Vec3(0.2, -0.1, -1).normalized()});
  for (int k = 0; k < 40; ++k) at.push_back({{2e4 + k, -1e4, 1e5}, Vec3(-0.2, 0.1, -1).normalized()});
  for (const auto part : {std::span(at).first(40), std::span(at).last(40)}) {
    const Difference d =
        compare(field, {.method = Method::position_dependent_printed, .samples = 60}, {part.begin(), part.end()});
    EXPECT_LT(d.rms, rounding);
    EXPECT_LE(d.far_off, strays);
  }
}

TEST_F(DeviceMethods, LightsAndFarFieldAreThoseOfTheHost) {
  for (const BasisKind basis : {BasisKind::tent, BasisKind::bell, BasisKind::bspline2})
    for (const int channels : {1, 3}) {
      const LightField field = small_luminaire(basis, channels);
      for (const Method method : {Method::precomputed_lights, Method::far_field}) {
        const Difference d = compare(field, {.method = method, .samples = 500}, receivers(false));
        EXPECT_LT(d.rms, rounding) << to_string(method) << ' ' << to_string(basis) << ' ' << channels;
        EXPECT_EQ(d.far_off, 0) << to_string(method) << ' ' << to_string(basis) << ' ' << channels;
      }
    }
}

TEST_F(DeviceMethods, AllSettingsReachTheKernel) {
  const LightField field = small_luminaire(BasisKind::bell, 1);
  for (const MethodSettings& settings :
       {MethodSettings{.method = Method::position_dependent, .samples = 300, .k_max = 7, .seed = 9},
        MethodSettings{.method = Method::position_dependent, .samples = 37.5, .sequence = PointSequence::twister},
        MethodSettings{.method = Method::uniform_box, .samples = 5, .seed = 4, .sequence = PointSequence::twister}}) {
    const Difference d = compare(field, settings, receivers(true));
    EXPECT_LT(d.rms, rounding);
    EXPECT_LE(d.far_off, strays);
  }
}

TEST_F(DeviceMethods, WideAndTallBoxesAreSearchedRight) {
  // Supports of 12 to 200 pixels: one vector, several, and the scalar search.
  LightField field = make_luminaire({.name = "fine",
                                     .separation_mm = 60,
                                     .spacing_mm = 16,
                                     .columns = 2,
                                     .rows = 2,
                                     .pixels = 256,
                                     .pixel_mm = 0.2,
                                     .lobes = 8,
                                     .spread_mm = 30,
                                     .least_width_mm = 1,
                                     .greatest_width_mm = 6});
  std::vector<Receiver> at;
  for (int k = 0; k < 60; ++k) at.push_back({{0.7 * k - 20, 12 - 0.4 * k, 64.0 + 6 * k}, {0, 0, -1}});
  const Difference d = compare(field, {.method = Method::position_dependent, .samples = 100}, at);
  EXPECT_LT(d.rms, rounding);
  EXPECT_LE(d.far_off, strays);
}

TEST_F(DeviceMethods, ThePlainKernelDrawsTheSame) {
  const LightField field = small_luminaire(BasisKind::bspline2, 1);
  const MethodSettings settings{.method = Method::position_dependent, .samples = 100};
  std::vector<double> sums[2];
  for (const bool plain : {false, true}) {
    const auto device = ImageSamplerDevice::create(field.geometry(), settings, SamplingSteps::all, plain).value();
    ASSERT_TRUE(device->set_cells(field));
    ASSERT_TRUE(device->set_receivers(receivers(true)));
    ASSERT_TRUE(device->evaluate(HUGE_VAL).value());
    ASSERT_TRUE(device->read(sums[plain]));
  }
  int other = 0, lit = 0;
  for (std::size_t k = 0; k < sums[0].size(); ++k) {
    other += !(std::abs(sums[0][k] - sums[1][k]) <= 1e-4 * std::abs(sums[1][k]));
    lit += sums[1][k] > 0;
  }
  EXPECT_LE(other, strays);
  EXPECT_GT(lit, 200) << "of 300 receivers";
}

TEST_F(DeviceMethods, TheReferenceIsTheHosts) {
  const LightField field = small_luminaire(BasisKind::bell, 3);
  const Difference d = compare(field, {.method = Method::reference}, receivers(true));
  EXPECT_EQ(d.rms, 0);
  EXPECT_EQ(d.far_off, 0);
}

TEST_F(DeviceMethods, EvaluateInPiecesIsTheWhole) {
  const LightField field = small_luminaire(BasisKind::bell, 1);
  std::vector<Receiver> many;
  for (int k = 0; k < 30; ++k)
    for (const Receiver& each : receivers(true)) many.push_back(each);
  for (const Method method : {Method::position_dependent, Method::reference}) {
    const auto device = make_device_method(field.geometry(), {.method = method, .samples = 20}).value();
    ASSERT_TRUE(device->set_cells(field));
    ASSERT_TRUE(device->set_receivers(many));
    std::vector<double> whole, pieces;
    ASSERT_TRUE(device->evaluate(HUGE_VAL).value());
    ASSERT_TRUE(device->read(whole));
    ASSERT_GT(std::ranges::count_if(whole, [](double e) { return e > 0; }), 6000) << "of 9,000 receivers";
    ASSERT_TRUE(device->set_receivers(many));
    int calls = 1;
    while (!device->evaluate(0).value()) ++calls;
    ASSERT_TRUE(device->read(pieces));
    EXPECT_GT(calls, 1);
    EXPECT_EQ(whole, pieces);

    // Other samples begin anew.
    ASSERT_TRUE(device->set_samples(20, 2));
    ASSERT_TRUE(device->evaluate(HUGE_VAL).value());
    ASSERT_TRUE(device->read(pieces));
    EXPECT_EQ(whole == pieces, method == Method::reference);
  }
}

TEST_F(DeviceMethods, RefuseWhatTheirHostFormsRefuse) {
  const LightField field = small_luminaire(BasisKind::bell, 1);
  const LuminaireGeometry& g = field.geometry();
  const std::vector<Receiver> between{{{0, 0, 100}, {0, 0, -1}}, {{0, 0, 30}, {0, 0, -1}}};
  const auto printed = make_device_method(g, {.method = Method::position_dependent_printed}).value();
  const Status refused = printed->set_receivers(between);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().where, "receiver 1");
  const auto lights = make_device_method(g, {.method = Method::precomputed_lights}).value();
  EXPECT_FALSE(lights->set_receivers(std::vector<Receiver>{{{0, 0, 60}, {0, 0, -1}}}));
  const auto sampled = make_device_method(g, {.method = Method::position_dependent}).value();
  EXPECT_FALSE(sampled->set_receivers(std::vector<Receiver>{{{0, std::nan(""), 60}, {0, 0, -1}}}));
  EXPECT_FALSE(sampled->set_cells(small_luminaire(BasisKind::tent, 1)));
  EXPECT_FALSE(make_device_method(g, {.method = Method::position_dependent, .samples = 0.5}));

  LightField negative = field;
  CellImage image = *field.cell({0, 0});
  image.value[5] = -1;
  ASSERT_TRUE(negative.add({0, 0}, std::move(image)));
  EXPECT_FALSE(printed->set_cells(negative));
  EXPECT_TRUE(sampled->set_cells(negative));
}

TEST_F(DeviceMethods, SharedStructsLieAlike) {
  const std::vector<int> layout = test::layout_by("position_dependent", "sampling_layout", 11);
  EXPECT_EQ(layout, (std::vector<int>{sizeof(SamplingGeometry), offsetof(SamplingGeometry, width),
                                      offsetof(SamplingGeometry, first_receiver), offsetof(SamplingGeometry, seed),
                                      sizeof(SamplingReceiver), offsetof(SamplingReceiver, n_z), sizeof(SamplingCell),
                                      offsetof(SamplingCell, shift_x), offsetof(SamplingCell, first_light),
                                      sizeof(SamplingLooks), offsetof(SamplingLooks, grid_columns)}));
}

}  // namespace
}  // namespace lumifield
