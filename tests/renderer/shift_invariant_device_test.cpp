// Spotlights by OpenGL against their host form in double.
#include "renderer/shift_invariant/shift_invariant_device.h"

#include <cmath>
#include <gtest/gtest.h>

#include "renderer/renderer.h"
#include "renderer/shift_invariant/shift_invariant.h"
#include "renderer/study/synthetic_luminaire.h"
#include "tests/support/closed_form_cases.h"
#include "tests/support/random_looks.h"

namespace lumifield {
namespace {

/// What is measured of a luminaire.
struct Cells {
  explicit Cells(const LightField& field) {
    const Sampling& sampling = field.geometry().sampling;
    for (int flat = 0; flat < sampling.cells(); ++flat)
      if (auto image = field.cell(sampling.index(flat))) {
        indices.push_back(sampling.index(flat));
        images.push_back(std::move(image));
      }
  }
  std::vector<CellIndex> indices;
  std::vector<std::shared_ptr<const CellImage>> images;
};

std::vector<double> irradiance_of(RunningSums& sums, const LightField& field, std::span<const Receiver> at,
                                  const Appearance& appearance = {}) {
  const Cells cells(field);
  const Status set = sums.set_receivers(at, appearance);
  EXPECT_TRUE(set) << set.error().message();
  const Status added = sums.add_cells(cells.indices, cells.images);
  EXPECT_TRUE(added) << added.error().message();
  std::vector<double> e;
  const Status read = sums.read(e);
  EXPECT_TRUE(read) << read.error().message();
  return e;
}

LightField magnitude_of(const LightField& field) {
  LightField magnitude(field.geometry());
  const Cells cells(field);
  for (std::size_t k = 0; k < cells.indices.size(); ++k) {
    CellImage image = *cells.images[k];
    for (float& v : image.value) v = std::abs(v);
    EXPECT_TRUE(magnitude.add(cells.indices[k], std::move(image)));
  }
  return magnitude;
}

/// What n·(u − p) rounds with: the light of a receiver that faces U, times its terms.
double terms_of(const ShiftInvariant& magnitude, const LuminaireGeometry& g, const Receiver& at, std::size_t c) {
  const double z = lit_height_mm(at.p_mm.z());
  if (!(z > 0)) return 0;
  double most = 0;
  for (int flat = 0; flat < g.sampling.cells(); ++flat) {
    const Vec2 u = g.sampling.cell_center_mm(g.sampling.index(flat));
    most = std::max(most, at.n.cwiseAbs().dot(Vec3(u.x() - at.p_mm.x(), u.y() - at.p_mm.y(), -z).cwiseAbs()));
  }
  return magnitude.irradiance({at.p_mm, {0, 0, -1}}, 0).value()[c] * most / z;
}

class ShiftInvariantDeviceOf : public testing::TestWithParam<std::tuple<BasisKind, int>> {
 protected:
  void SetUp() override {
    if (const auto found = probe_opengl(); !found) GTEST_SKIP() << found.error().message();
  }
};
INSTANTIATE_TEST_SUITE_P(All, ShiftInvariantDeviceOf,
                         testing::Combine(testing::Values(BasisKind::box, BasisKind::tent, BasisKind::bell,
                                                          BasisKind::bspline2),
                                          testing::Values(1, 3)));

/// As many roundings of float as the stability table allows kernels.
TEST_P(ShiftInvariantDeviceOf, WeightedIsTheHostFormToRounding) {
  const auto [basis, channels] = GetParam();
  const LightField field = random_luminaire(basis, channels, 7);
  const ShiftInvariant host(field, {}), magnitude(magnitude_of(field), {});
  const auto n = static_cast<std::size_t>(channels);
  std::vector<Receiver> at;
  const auto cases = receiver_cases(field.geometry(), 8);
  for (const ReceiverCase& each : cases) at.push_back({each.p_mm, each.n});
  for (const int x : {1, 3, 64}) {
    const auto device = ShiftInvariantDevice::create(field.geometry(), {.cells_per_pass = x}).value();
    const std::vector<double> e = irradiance_of(*device, field, at);
    ASSERT_EQ(e.size(), n * at.size());
    int lit = 0;
    for (std::size_t k = 0; k < at.size(); ++k) {
      const auto wanted = host.irradiance(at[k], 0).value(), most = magnitude.irradiance(at[k], 0).value();
      for (std::size_t c = 0; c < n; ++c) {
        const double terms = terms_of(magnitude, field.geometry(), at[k], c);
        EXPECT_NEAR(e[n * k + c], wanted[c], 0x1p-24 * (64 * most[c] + 4 * terms)) << cases[k].name << ", X = " << x;
        lit += e[n * k + c] != 0;
      }
    }
    EXPECT_GT(lit, 90 * channels);
  }
}

/// Where it is to be used: not on S, and not so near U or far away that floats have no digits.
TEST_P(ShiftInvariantDeviceOf, TexturedIsTheHostsLookUp) {
  const auto [basis, channels] = GetParam();
  const LightField field = make_luminaire({.name = "small",
                                           .basis = basis,
                                           .separation_mm = 60,
                                           .spacing_mm = 16,
                                           .columns = 4,
                                           .rows = 3,
                                           .pixels = 70,
                                           .pixel_mm = 1,
                                           .lobes = 8,
                                           .spread_mm = 30,
                                           .least_width_mm = 2,
                                           .greatest_width_mm = 12},
                                          channels);
  const SpotSettings settings{.look_up = SpotLookUp::textured};
  const ShiftInvariant host(field, settings);
  const auto device = ShiftInvariantDevice::create(field.geometry(), settings).value();
  const auto n = static_cast<std::size_t>(channels);
  std::vector<Receiver> at;
  for (int k = 0; k < 300; ++k) {
    const double z = 20 + 3 * k;
    at.push_back({{z * 0.4 * std::sin(1.3 * k), z * 0.4 * std::cos(2.1 * k), z},
                  Vec3(0.3 * std::sin(k), 0.3 * std::cos(k), -1).normalized()});
  }
  const std::vector<double> e = irradiance_of(*device, field, at);
  double most = 0;
  for (const Receiver& each : at) most = std::max(most, host.irradiance(each, 0).value()[0]);
  ASSERT_GT(most, 0);
  for (std::size_t k = 0; k < at.size(); ++k) {
    const auto wanted = host.irradiance(at[k], 0).value();
    for (std::size_t c = 0; c < n; ++c) EXPECT_NEAR(e[n * k + c], wanted[c], 1e-4 * most) << k;
  }
}

}  // namespace
}  // namespace lumifield
