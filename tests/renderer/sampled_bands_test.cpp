// The first piece of an evaluation is as large whatever a method draws for a receiver: of a slice no more is meant.
#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>

#include "renderer/methods/device_method.h"
#include "renderer/methods/mis.h"
#include "renderer/renderer.h"
#include "tests/support/small_luminaire.h"

namespace lumifield {
namespace {

constexpr double samples = 100;
constexpr double first_rays = 1e5;

/// Receivers that the first piece has computed, of those that are lit alike.
int first_band(Method method, bool glossy) {
  const LightField field = make_luminaire(test::small_luminaire());
  const std::vector<Receiver> at(4000, {{3, -2, 140}, {0, 0, -1}});
  const auto device = make_device_method(field.geometry(), {.method = method, .samples = samples}).value();
  EXPECT_TRUE(device->set_cells(field));
  Appearance appearance;
  if (glossy) appearance.gloss.assign(at.size(), {0, 0, -1, 0.3F, 0.5F, 0.5F, 0.5F, LOBE_GGX});
  EXPECT_TRUE(device->set_receivers(at, appearance));
  EXPECT_FALSE(device->evaluate(0).value());
  std::vector<double> e;
  EXPECT_TRUE(device->read(e));
  return static_cast<int>(std::ranges::count_if(e, [](double v) { return v != 0; }));
}

class SampledBands : public testing::Test {
 protected:
  void SetUp() override {
    if (const auto found = probe_opencl(); !found) GTEST_SKIP() << found.error().message();
  }
};

TEST_F(SampledBands, LightSamplesAloneAreK) {
  for (const bool glossy : {false, true})
    EXPECT_EQ(first_band(Method::position_dependent, glossy), std::floor(first_rays / samples));
}

TEST_F(SampledBands, LobeSamplesAreKOfEachKind) {
  EXPECT_EQ(first_band(Method::filtered_brdf, false), std::floor(first_rays / samples));
  EXPECT_EQ(first_band(Method::filtered_brdf, true), std::floor(first_rays / (2 * samples)));
}

TEST_F(SampledBands, OfTwoTechniquesTheMostOfBothCount) {
  const MisCounts n = mis_counts(samples);
  EXPECT_EQ(first_band(Method::mis, false), std::floor(first_rays / (n.light + n.diffuse)));
  const double most = std::max(n.light + n.diffuse, n.light_apart + n.glossy);
  EXPECT_GT(most, 2 * samples);
  EXPECT_EQ(first_band(Method::mis, true), std::floor(first_rays / most));
}

}  // namespace
}  // namespace lumifield
