#include "renderer/methods/closed_form_evaluation.h"

#include <cmath>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "renderer/methods/host_method.h"
#include "renderer/renderer.h"
#include "tests/support/closed_form_cases.h"

namespace lumifield {
namespace {

using testing::HasSubstr;

class ClosedFormEvaluationTest : public testing::Test {
 protected:
  void SetUp() override {
    if (const auto found = probe_opencl(); !found) GTEST_SKIP() << found.error().message();
  }
  static std::unique_ptr<DeviceMethod> make(const LuminaireGeometry& geometry, Method method = Method::closed_form) {
    auto made = make_device_method(geometry, {.method = method});
    EXPECT_TRUE(made) << made.error().message();
    return std::move(*made);
  }
  static std::vector<double> read(DeviceMethod& method) {
    std::vector<double> e;
    EXPECT_TRUE(method.read(e));
    return e;
  }

  const LightField field = random_luminaire(BasisKind::bell, 1, 3);
  const std::vector<Receiver> receivers = {{{3, -2, 400}, Vec3(0.1, 0.2, -1).normalized()},
                                           {{-20, 8, 250}, {0, 0, -1}}};
};

TEST_F(ClosedFormEvaluationTest, WithoutCellsThereIsNoAnswer) {
  for (const Method method : {Method::closed_form, Method::reference}) {
    const auto evaluation = make(field.geometry(), method);
    ASSERT_TRUE(evaluation->set_receivers(receivers));
    const auto none = evaluation->evaluate(HUGE_VAL);
    ASSERT_FALSE(none);
    EXPECT_THAT(none.error().message(), HasSubstr("cells"));
  }
}

TEST_F(ClosedFormEvaluationTest, PiecesAddUpToTheWhole) {
  const auto whole = make(field.geometry()), pieces = make(field.geometry());
  for (const auto* each : {&whole, &pieces}) {
    ASSERT_TRUE((*each)->set_cells(field));
    ASSERT_TRUE((*each)->set_receivers(receivers));
  }
  ASSERT_TRUE(whole->evaluate(HUGE_VAL).value());
  int calls = 1;
  while (!pieces->evaluate(0).value()) ++calls;
  EXPECT_EQ(calls, field.geometry().sampling.rows);
  const std::vector<double> expected = read(*whole), e = read(*pieces);
  ASSERT_EQ(e.size(), receivers.size());
  for (std::size_t k = 0; k < e.size(); ++k) {
    EXPECT_NE(expected[k], 0);
    EXPECT_NEAR(e[k], expected[k], 1e-6 * std::abs(expected[k]));
  }
  // Another evaluation begins anew.
  ASSERT_TRUE(pieces->evaluate(HUGE_VAL).value());
  EXPECT_EQ(read(*pieces), expected);
}

TEST_F(ClosedFormEvaluationTest, WhatIsRefusedLeavesTheReceivers) {
  const auto method = make(field.geometry());
  ASSERT_TRUE(method->set_cells(field));
  ASSERT_TRUE(method->set_receivers(receivers));
  ASSERT_TRUE(method->evaluate(HUGE_VAL));
  const std::vector<double> before = read(*method);
  EXPECT_FALSE(method->set_receivers(std::vector<Receiver>{{{0, 0, std::nan("")}, {0, 0, -1}}}));
  EXPECT_FALSE(method->set_samples(-1, 0));
  ASSERT_TRUE(method->evaluate(HUGE_VAL).value());
  EXPECT_EQ(read(*method), before);
}

TEST_F(ClosedFormEvaluationTest, AReferenceReadMidwayHoldsNothingOld) {
  const auto method = make(field.geometry(), Method::reference);
  std::vector<Receiver> many(1000, receivers[0]);
  ASSERT_TRUE(method->set_cells(field));
  ASSERT_TRUE(method->set_receivers(many));
  ASSERT_TRUE(method->evaluate(HUGE_VAL).value());
  EXPECT_NE(read(*method).back(), 0);
  ASSERT_FALSE(method->evaluate(0).value());
  EXPECT_NE(read(*method).front(), 0);
  EXPECT_EQ(read(*method).back(), 0);
}

TEST_F(ClosedFormEvaluationTest, SettingsThatWouldNotBeHeededAreRefused) {
  for (const MethodInfo& each : methods()) {
    const bool importance =
        each.method == Method::position_dependent || each.method == Method::position_dependent_printed;
    EXPECT_EQ(make_device_method(field.geometry(), {.method = each.method, .k_max = 7}).has_value(), importance)
        << each.name;
    if (each.method == Method::reference) continue;
    EXPECT_FALSE(make_device_method(field.geometry(), {.method = each.method, .inversion = Inversion::bisection}))
        << each.name;
    EXPECT_FALSE(make_device_method(field.geometry(), {.method = each.method, .depth = 3})) << each.name;
  }
}

TEST_F(ClosedFormEvaluationTest, TheLightStaysHoweverNearAReceiverIsToTheFilter) {
  const auto device = make(field.geometry());
  const ClosedForm host(field);
  std::vector<Receiver> near;
  for (const double z : {1e-7, 1e-9, 1e-12, 1e-20, 1e-40, 1e-103, 1e-200, 4.9e-324})
    near.push_back({{1, -2, z}, {0, 0.6, -0.8}});
  ASSERT_TRUE(device->set_cells(field));
  ASSERT_TRUE(device->set_receivers(near));
  ASSERT_TRUE(device->evaluate(HUGE_VAL));
  const std::vector<double> e = read(*device);
  for (std::size_t k = 0; k < near.size(); ++k) {
    const double expected = host.irradiance(near[0])[0];
    EXPECT_NE(expected, 0);
    EXPECT_NEAR(host.irradiance(near[k])[0], expected, 1e-6 * std::abs(expected)) << k;
    EXPECT_NEAR(e[k], expected, 1e-3 * std::abs(expected)) << k;
  }
}

}  // namespace
}  // namespace lumifield
