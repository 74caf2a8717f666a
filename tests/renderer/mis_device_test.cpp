// The kernel against its host form in double: the same draws and weights, so the same light but for the few draws that
// rounding puts into another pixel.
#include <cmath>
#include <gtest/gtest.h>

#include "renderer/methods/device_method.h"
#include "renderer/methods/host_method.h"
#include "renderer/methods/mis_shared.h"
#include "renderer/opencl/device.h"
#include "renderer/renderer.h"
#include "tests/support/random_looks.h"
#include "tests/support/small_luminaire.h"

namespace lumifield {
namespace {

std::vector<Receiver> receivers() {
  std::vector<Receiver> all;
  for (int k = 0; k < 150; ++k) {
    const double x = 40 * std::sin(1.3 * k), y = 30 * std::cos(2.1 * k);
    const double heights[] = {90, 140, 250, 700, 62, 60, 59, 35, 5, -4};
    const double z = heights[k % 10];
    all.push_back({{x * z / 150, y * z / 150, z}, Vec3(0.3 * std::sin(k), 0.3 * std::cos(k), -1).normalized()});
  }
  all[7].n = {0, 0, 0};
  return all;
}

/// Every other one mirrors a point of the lamp or beside it.
std::vector<GlossLobe> lobes(const std::vector<Receiver>& at, bool coloured) {
  std::vector<GlossLobe> all = test::random_lobes(at, coloured);
  for (std::size_t k = 0; k < at.size(); k += 2) {
    const Vec3 to = (Vec3(40 * std::sin(0.7 * double(k)), 30 * std::cos(1.1 * double(k)), 0) - at[k].p_mm).normalized();
    const Eigen::Vector3f eye = (2 * at[k].n.dot(to) * at[k].n - to).cast<float>();
    all[k].eye_x = eye.x();
    all[k].eye_y = eye.y();
    all[k].eye_z = eye.z();
  }
  return all;
}

class MisDevice : public testing::TestWithParam<std::tuple<BasisKind, int, bool, PointSequence>> {
 protected:
  void SetUp() override {
    if (const auto found = probe_opencl(); !found) GTEST_SKIP() << found.error().message();
  }
};
INSTANTIATE_TEST_SUITE_P(All, MisDevice,
                         testing::Combine(testing::Values(BasisKind::box, BasisKind::tent, BasisKind::bell,
                                                          BasisKind::bspline2),
                                          testing::Values(1, 3), testing::Bool(),
                                          testing::Values(PointSequence::halton, PointSequence::twister)));

TEST_P(MisDevice, DrawsAndWeighsAsItsHostFormDoes) {
  const auto [basis, channels, filter, sequence] = GetParam();
  SyntheticLuminaire small = test::small_luminaire();
  small.basis = basis;
  small.seed = 5;
  const LightField field = make_luminaire(small, channels);
  const std::vector<Receiver> at = receivers();
  const MethodSettings settings{
      .method = Method::mis, .samples = 40, .seed = 3, .sequence = sequence, .filter = filter};
  const auto host = make_host_method(field, settings).value();
  const auto device = make_device_method(field.geometry(), settings).value();
  ASSERT_TRUE(device->set_cells(field));
  for (const bool looks : {false, true}) {
    const auto weighing = basis == BasisKind::tent ? ShadowWeighing::mean : ShadowWeighing::tile;
    Appearance appearance;
    if (looks)
      appearance = {lobes(at, basis == BasisKind::bell),
                    test::random_visibility(field.geometry().sampling, at.size(), weighing)};
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
      // Lobes of light samples are in float.
      const auto compare = [&](double got, double want, double share) {
        EXPECT_TRUE(std::isfinite(got));
        strays += std::abs(got - want) > share * std::abs(want) + 1e-7;
      };
      for (std::size_t c = 0; c < values; ++c) compare(e[k * values + c], wanted[c], 1e-5), all += wanted[c];
      const std::size_t given = wanted.size() - values;
      for (std::size_t c = 0; given > 0 && c < outs; ++c)
        compare(gloss[k * outs + c], wanted[values + c % given], 5e-5), shone += wanted[values + c % given];
    }
    EXPECT_GT(all, 0);
    EXPECT_EQ(shone > 0, looks);
    EXPECT_LE(strays, 4 * channels);
  }
}

TEST(MisStructs, LieAlike) {
  if (const auto found = probe_opencl(); !found) GTEST_SKIP() << found.error().message();
  auto device = OpenClDevice::create().value();
  auto kernel = device->build("mis", "", "mis_layout").value();
  std::vector<int> layout(3);
  const auto buffer = device->allocate(layout.size() * sizeof(int), "layout").value();
  kernel.set(0, buffer);
  ASSERT_TRUE(device->run(kernel, 1, 1));
  ASSERT_TRUE(device->read(buffer, std::as_writable_bytes(std::span(layout))));
  EXPECT_EQ(layout,
            (std::vector<int>{sizeof(MisShares), offsetof(MisShares, diffuse), offsetof(MisShares, narrow_points)}));
}

}  // namespace
}  // namespace lumifield
