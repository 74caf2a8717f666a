// Receivers so near S that a support spans small parts of a pixel: the kernels against their host forms, where
// positions in float have no digits left.
#include <cmath>
#include <gtest/gtest.h>

#include "renderer/methods/device_method.h"
#include "renderer/methods/host_method.h"
#include "renderer/methods/position_dependent_printed.h"
#include "renderer/renderer.h"
#include "renderer/study/synthetic_luminaire.h"
#include "tests/support/small_luminaire.h"

namespace lumifield {
namespace {

/// One cell of one row of pixels, each light, or the one at `lit` alone, far from the image's corner
/// and the frame's origin.
LightField row_of_pixels(double pixel_x_mm, double pixel_y_mm, int width_px, int lit) {
  LuminaireGeometry g;
  g.planes.separation_mm = 60;
  g.sampling = {BasisKind::bell, {16, 16}, 1, 1, {123.4, 0}};
  g.measurement = {width_px, 1, {pixel_x_mm, pixel_y_mm}, {0, 0}};
  g.measurement.center_mm.x() = 123.4 + (width_px / 2.0 - lit - 0.5) * pixel_x_mm;
  g.channels = {"Y"};
  LightField field(g);
  std::vector<float> value(static_cast<std::size_t>(width_px), 0.0F);
  value[static_cast<std::size_t>(lit)] = 1;
  EXPECT_TRUE(field.add({0, 0}, CellImage{width_px, 1, 1, std::move(value), {}, {}}));
  return field;
}

/// Where a support spans this many pixels along x, before the middle of the lit pixel.
Receiver at_span(const LightField& field, double span_px, double x_px) {
  const LuminaireGeometry& g = field.geometry();
  const double r = span_px * g.measurement.pixel_mm.x() / (2 * g.sampling.spacing_mm.x());
  const double z = g.planes.separation_mm / (1 - r);
  return {{123.4 + x_px * g.measurement.pixel_mm.x(), 0, z}, {0, 0, -1}};
}

/// RMS of the difference over the RMS of the host's.
double apart(const LightField& field, const MethodSettings& settings, const std::vector<Receiver>& at) {
  const auto host = make_host_method(field, settings).value();
  const auto device = make_device_method(field.geometry(), settings).value();
  EXPECT_TRUE(device->set_cells(field));
  EXPECT_TRUE(device->set_receivers(at));
  EXPECT_TRUE(device->evaluate(HUGE_VAL).value());
  std::vector<double> got;
  EXPECT_TRUE(device->read(got));
  double squares = 0, all = 0;
  for (std::size_t k = 0; k < at.size(); ++k) {
    const double wanted = host->irradiance(at[k], static_cast<std::uint32_t>(k)).value()[0];
    EXPECT_GT(wanted, 0) << "receiver " << k << " is lit";
    squares += std::pow(got[k] - wanted, 2);
    all += wanted * wanted;
  }
  return std::sqrt(squares / all);
}

class NearPlanes : public testing::Test {
 protected:
  void SetUp() override {
    if (const auto found = probe_opencl(); !found) GTEST_SKIP() << found.error().message();
  }
};

TEST_F(NearPlanes, PrecomputedLightsNearSLieWhereTheHostHasThem) {
  // A million lights in one pixel of 4000, of which a support of 1e-4 pixels shows about a hundred. Pixels are as much
  // narrower along y, so that there a support spans half a pixel.
  const LightField field = row_of_pixels(5, 1e-3, 4000, 3000);
  std::vector<Receiver> at;
  for (int k = 0; k < 20; ++k) at.push_back(at_span(field, 1e-4, 0.03 * k - 0.3));
  EXPECT_LT(apart(field, {.method = Method::precomputed_lights, .samples = 1e6}, at), 1e-4);
}

TEST_F(NearPlanes, ThePrintedMethodHasItsDigitsAtItsLimit) {
  const LightField field = row_of_pixels(1, 1, 300, 250);
  std::vector<Receiver> at;
  for (int k = 0; k < 20; ++k) at.push_back(at_span(field, 1.001 * printed_least_span_px, 0.03 * k - 0.3));
  EXPECT_LT(apart(field, {.method = Method::position_dependent_printed, .samples = 50}, at), 1e-5);
}

LightField whole_luminaire() { return make_luminaire(test::small_luminaire()); }

TEST_F(NearPlanes, KernelsKeepTheirDigitsNearU) {
  const LightField field = whole_luminaire();
  for (const Method method : {Method::closed_form, Method::position_dependent, Method::precomputed_lights}) {
    std::vector<Receiver> at;
    for (const double z : {1e-1, 1e-3, 1e-5, 1e-6, 1e-7, 1e-8, 1.01 * least_height_mm})
      for (const Vec3& n : {Vec3(0, 0, -1), Vec3(0.3, -0.2, -0.9)}) at.push_back({{3.3, -2.1, z}, n.normalized()});
    EXPECT_LT(apart(field, {.method = method, .samples = 1000}, at), 1e-5) << to_string(method);
  }
}

TEST_F(NearPlanes, WhatIsNearerToUCountsAsThatNearAndOnUThereIsNoLight) {
  const LightField field = whole_luminaire();
  const double heights[] = {least_height_mm, 0.99 * least_height_mm, 1e-104, 1e-200, 5e-324, 0.0, -0.0, -1e-110};
  for (const MethodInfo& each : methods()) {
    if (each.method == Method::position_dependent_printed) continue;  // has no answer between the planes
    const MethodSettings settings{.method = each.method, .samples = 1000};
    const auto host = make_host_method(field, settings).value();
    const auto device = make_device_method(field.geometry(), settings).value();
    ASSERT_TRUE(device->set_cells(field));
    for (const Vec3& n : {Vec3(0, 0, -1), Vec3(0.3, -0.2, -0.9)}) {
      double least[2] = {};
      for (const double z : heights) {
        const Receiver at{{3.3, -2.1, z}, n.normalized()};
        std::vector<double> got;
        ASSERT_TRUE(device->set_receivers(std::span(&at, 1)));
        ASSERT_TRUE(device->evaluate(HUGE_VAL).value());
        ASSERT_TRUE(device->read(got));
        const double e = host->estimate(at, 0).value().irradiance[0];
        if (z == least_height_mm) {
          least[0] = e;
          least[1] = got[0];
          if (each.method != Method::uniform_box && each.method != Method::far_field) {
            EXPECT_GT(e, 0) << each.name;
          }
        }
        EXPECT_EQ(e, z > 0 ? least[0] : 0) << each.name << ", " << z;
        EXPECT_EQ(got[0], z > 0 ? least[1] : 0) << each.name << ", " << z;
      }
    }
  }
}

TEST(NearU, TheClosedFormHasItsLimitThere) {
  // E is continuous down to U: what a hundred-thousandth of a millimetre changes is far less than 1e-5.
  const ClosedForm form(whole_luminaire());
  for (const Vec3& n : {Vec3(0, 0, -1), Vec3(0.3, -0.2, -0.9)}) {
    const double limit = form.irradiance({{3.3, -2.1, 1e-5}, n})[0];
    for (const double z : {1e-6, 1e-7, 1e-8, least_height_mm})
      EXPECT_NEAR(form.irradiance({{3.3, -2.1, z}, n})[0], limit, 1e-5 * limit) << z;
  }
}

}  // namespace
}  // namespace lumifield
