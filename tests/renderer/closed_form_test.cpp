#include "renderer/methods/closed_form.h"

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <gtest/gtest.h>
#include <map>
#include <thread>

#include "renderer/study/definition_quadrature.h"
#include "tests/support/closed_form_cases.h"

namespace lumifield {
namespace {

class ClosedFormOf : public testing::TestWithParam<BasisKind> {};
INSTANTIATE_TEST_SUITE_P(All, ClosedFormOf,
                         testing::Values(BasisKind::box, BasisKind::tent, BasisKind::bell, BasisKind::bspline2),
                         [](const auto& each) { return std::string(to_string(each.param)); });

TEST_P(ClosedFormOf, EqualsTheDefinition) {
  std::map<std::string, double> worst;
  for (int channels : {1, 3}) {
    const LightField field = random_luminaire(GetParam(), channels, 11);
    const ClosedForm closed_form(field);
    for (const ReceiverCase& each : receiver_cases(field.geometry(), 12)) {
      const std::vector<double> e = closed_form.irradiance({each.p_mm, each.n});
      const DefinitionValue expected = definition_quadrature(field, each.p_mm, each.n);
      for (std::size_t c = 0; c < e.size(); ++c) {
        const double error = std::abs(e[c] - expected.irradiance[c]);
        // A cut next to U needs the place of pixels that are a millionth of a cell wide.
        const double tolerance = each.cut_horizon && each.p_mm.z() < 0.1 ? 1e-10 : 1e-12;
        EXPECT_LE(error, tolerance * expected.magnitude[c])
            << each.name << " p " << each.p_mm.transpose() << " n " << each.n.transpose();
        if (expected.magnitude[c] > 0) worst[each.name] = std::max(worst[each.name], error / expected.magnitude[c]);
      }
    }
  }
  if (std::getenv("LUMIFIELD_PRINT_ERRORS"))
    for (const auto& [name, error] : worst) std::printf("%-24s %.1e\n", name.c_str(), error);
}

TEST_P(ClosedFormOf, IsZeroOnAndBehindU) {
  const LightField field = random_luminaire(GetParam(), 1, 3);
  const ClosedForm closed_form(field);
  for (double z : {0.0, -0.0, -1e-300, -48.0, -1e5})
    for (double n : {-1, 1}) EXPECT_EQ(closed_form.irradiance({{0, 0, z}, {0, 0, n}})[0], 0) << z;
}

TEST_P(ClosedFormOf, ApproachesUWithoutLosingDigits) {
  const LightField field = random_luminaire(GetParam(), 1, 5);
  const ClosedForm closed_form(field);
  const Vec2 center = field.geometry().sampling.cell_center_mm({1, 1});
  for (double z : {1e-6, 1e-3, 0.1}) {
    const Vec3 p(center.x(), center.y(), z), n = Vec3(0.3, 0.2, -1).normalized();
    const DefinitionValue expected = definition_quadrature(field, p, n);
    EXPECT_GT(expected.magnitude[0], 0);
    EXPECT_LE(std::abs(closed_form.irradiance({p, n})[0] - expected.irradiance[0]), 1e-9 * expected.magnitude[0]) << z;
  }
}

/// A luminaire whose every image is 1 throughout has L = δ²/cos⁴θ wherever its bases sum to 1: (B) is then elementary.
TEST_P(ClosedFormOf, ConstantLuminaireHasAnElementaryIrradiance) {
  LuminaireGeometry g;
  g.planes.separation_mm = 100;
  g.sampling = {GetParam(), {4, 4}, 1, 1, {0, 0}};
  g.measurement = {100, 100, {1, 1}, {0, 0}};
  g.channels = {"Y"};
  LightField field(g);
  ASSERT_TRUE(field.add({0, 0}, {100, 100, 1, std::vector<float>(10000, 1.0f), {}, {}}));
  // δ²/(δ+Δ)³ · (δ+Δ) · a²
  const double e = ClosedForm(field).irradiance({{1, 2, 250}, {0, 0, -1}})[0];
  EXPECT_NEAR(e, 100 * 100 * 16 / (250.0 * 250.0), 1e-13 * e);
}

TEST(ClosedForm, AnswersSeveralThreadsAlike) {
  const LightField field = random_luminaire(BasisKind::bell, 3, 7);
  const ClosedForm closed_form(field);
  const auto cases = receiver_cases(field.geometry(), 8);
  const auto all = [&] {
    std::vector<double> values;
    for (const ReceiverCase& each : cases)
      for (double e : closed_form.irradiance({each.p_mm, each.n})) values.push_back(e);
    return values;
  };
  std::vector<double> first, second;
  std::thread other([&] { first = all(); });
  second = all();
  other.join();
  EXPECT_EQ(first, second);
}

TEST(ClosedForm, IsZeroWithoutCells) {
  const ClosedForm closed_form(LightField(random_luminaire(BasisKind::tent, 3, 1).geometry()));
  EXPECT_EQ(closed_form.irradiance({{0, 0, 100}, {0, 0, -1}}), std::vector<double>(3, 0.0));
}

}  // namespace
}  // namespace lumifield
