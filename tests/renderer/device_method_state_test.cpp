// What every method says when it is asked out of turn, and of settings that it has no use for.
#include <cmath>
#include <gtest/gtest.h>
#include <new>

#include "renderer/methods/device_method.h"
#include "renderer/methods/host_evaluation.h"
#include "renderer/renderer.h"
#include "renderer/study/synthetic_luminaire.h"
#include "tests/support/small_luminaire.h"

namespace lumifield {
namespace {

class DeviceMethodState : public testing::TestWithParam<Method> {
 protected:
  void SetUp() override {
    if (const auto found = probe_opencl(); !found) GTEST_SKIP() << found.error().message();
  }
  std::unique_ptr<DeviceMethod> make() const {
    return make_device_method(field_.geometry(), {.method = GetParam(), .samples = 50}).value();
  }
  static std::vector<double> read(DeviceMethod& method) {
    std::vector<double> e;
    EXPECT_TRUE(method.read(e));
    return e;
  }
  static std::vector<double> evaluated(DeviceMethod& method) {
    EXPECT_TRUE(method.evaluate(HUGE_VAL).value());
    return read(method);
  }
  static LightField luminaire(int pixels) {
    SyntheticLuminaire small = test::small_luminaire();
    small.pixels = pixels;
    return make_luminaire(small);
  }
  LightField field_ = luminaire(70);
  std::vector<Receiver> receivers_ = {{{3, -2, 140}, {0, 0, -1}}, {{-8, 5, 300}, {0, 0, -1}}};
};

INSTANTIATE_TEST_SUITE_P(All, DeviceMethodState,
                         testing::Values(Method::closed_form, Method::position_dependent,
                                         Method::position_dependent_printed, Method::uniform_box,
                                         Method::precomputed_lights, Method::filtered_brdf, Method::mis,
                                         Method::far_field, Method::shift_invariant, Method::reference),
                         [](const auto& each) {
                           std::string name(to_string(each.param));
                           std::erase(name, '-');
                           return name;
                         });

TEST_P(DeviceMethodState, WithoutCellsOrReceiversThereIsNoAnswer) {
  std::vector<double> e;
  const auto without_cells = make();
  ASSERT_TRUE(without_cells->set_receivers(receivers_));
  const auto refused = without_cells->evaluate(HUGE_VAL);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().message(), std::string(to_string(GetParam())) + ": has no cells; set them first");
  EXPECT_FALSE(without_cells->read(e));

  const auto without_receivers = make();
  ASSERT_TRUE(without_receivers->set_cells(field_));
  EXPECT_FALSE(without_receivers->evaluate(HUGE_VAL));
  EXPECT_FALSE(without_receivers->read(e));
  ASSERT_TRUE(without_receivers->set_receivers({}));
  EXPECT_TRUE(evaluated(*without_receivers).empty()) << "none is not the same as not set";
}

TEST_P(DeviceMethodState, CellsThatAreRefusedLeaveNone) {
  const auto method = make();
  ASSERT_TRUE(method->set_receivers(receivers_));
  ASSERT_TRUE(method->set_cells(field_));
  const std::vector<double> before = evaluated(*method);
  EXPECT_GT(before[0], 0);
  EXPECT_FALSE(method->set_cells(luminaire(64)));
  EXPECT_FALSE(method->evaluate(HUGE_VAL));
  ASSERT_TRUE(method->set_cells(field_));
  EXPECT_EQ(evaluated(*method), before);
}

TEST_P(DeviceMethodState, ReceiversThatAreRefusedLeaveThoseOfBefore) {
  const auto method = make();
  ASSERT_TRUE(method->set_receivers(receivers_));
  ASSERT_TRUE(method->set_cells(field_));
  const std::vector<double> before = evaluated(*method);
  const Status refused =
      method->set_receivers(std::vector<Receiver>{receivers_[1], receivers_[0], {{0, NAN, 9}, {0, 0, 1}}});
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().where, "receiver 2");
  EXPECT_EQ(evaluated(*method), before);
  ASSERT_TRUE(method->set_samples(50, 1));
  EXPECT_EQ(evaluated(*method), before);
}

TEST_P(DeviceMethodState, WhatChangesLeavesNothingComputed) {
  const auto method = make();
  ASSERT_TRUE(method->set_receivers(receivers_));
  ASSERT_TRUE(method->set_cells(field_));
  const std::vector<double> none(2, 0.0);
  EXPECT_EQ(read(*method), none);
  EXPECT_NE(evaluated(*method), none);
  ASSERT_TRUE(method->set_cells(field_));
  EXPECT_EQ(read(*method), none);
  EXPECT_NE(evaluated(*method), none);
  ASSERT_TRUE(method->set_samples(50, 2));
  EXPECT_EQ(read(*method), none);
}

TEST_P(DeviceMethodState, BadSamplesAreRefused) {
  const auto method = make();
  EXPECT_FALSE(method->set_samples(0.5, 1));
  EXPECT_FALSE(method->set_samples(NAN, 1));
}

TEST_P(DeviceMethodState, IsEvaluatedInPieces) {
  // Work for many pieces of any method: of receivers, or of cells.
  std::vector<Receiver> many;
  const int count = GetParam() == Method::far_field ? 120'000 : 5000;  // one look-up each, or many draws
  for (int k = 0; k < count; ++k) many.push_back(receivers_[static_cast<std::size_t>(k % 2)]);
  LuminaireGeometry wide = field_.geometry();
  wide.sampling.columns = 40;
  LightField field(wide);
  for (int k = 0; k < wide.sampling.cells(); ++k)
    ASSERT_TRUE(field.add(wide.sampling.index(k), field_.cell({k % 3, k % 4})));
  const auto method = make_device_method(wide, {.method = GetParam(), .samples = 50}).value();
  ASSERT_TRUE(method->set_cells(field));
  ASSERT_TRUE(method->set_receivers(many));
  const std::vector<double> whole = evaluated(*method);
  ASSERT_TRUE(method->set_cells(field));
  EXPECT_FALSE(method->evaluate(0).value());
  const std::vector<double> part = read(*method);
  for (std::size_t k = 0; k < whole.size(); ++k) EXPECT_TRUE(part[k] == 0 || part[k] == whole[k]) << "computed, or 0";
  if (GetParam() != Method::closed_form && GetParam() != Method::shift_invariant) {
    EXPECT_NE(part[0], 0) << "its pieces are receivers";
  }
  while (!method->evaluate(0).value()) continue;
  const std::vector<double> pieces = read(*method);
  // Sums in float round by the order of what they add.
  const double rounding = GetParam() == Method::shift_invariant ? 1e-6 : 1e-12;
  for (std::size_t k = 0; k < whole.size(); ++k) EXPECT_NEAR(pieces[k], whole[k], rounding * std::abs(whole[k]));
}

TEST_P(DeviceMethodState, SettingsThatAKernelHasNoUseForAreRefused) {
  const MethodSettings usual{.method = GetParam()};
  EXPECT_TRUE(make_device_method(field_.geometry(), usual));
  const auto refused_at = [&](const MethodSettings& settings) {
    const auto made = make_device_method(field_.geometry(), settings);
    return made ? std::string("not refused") : made.error().where;
  };
  MethodSettings settings = usual;
  settings.inversion = Inversion::bisection;
  EXPECT_EQ(refused_at(settings), "inversion");
  settings = usual;
  settings.depth = 3;
  EXPECT_EQ(refused_at(settings), "depth of the search");
  settings = usual;
  settings.k_max = 7;
  const bool shares_out = GetParam() == Method::position_dependent || GetParam() == Method::position_dependent_printed;
  EXPECT_EQ(refused_at(settings), shares_out ? "not refused" : "k_max");
}

/// Throws from some receiver on, as a form does that is out of memory.
class ThrowingForm final : public HostMethod {
 public:
  explicit ThrowingForm(std::uint32_t from) : from_(from) {}
  Result<std::vector<double>> light(const Receiver&, std::uint32_t number, const Look&) const override {
    if (number >= from_) throw std::bad_alloc();
    return std::vector<double>{1};
  }
  Result<Estimate> estimate(const Receiver&, std::uint32_t, const Look&) const override { return Estimate{{1}, {0}}; }

 private:
  std::uint32_t from_;
};

TEST(HostEvaluation, WhatAFormThrowsIsAnError) {
  const LightField field = make_luminaire({.name = "small", .columns = 2, .rows = 2, .pixels = 8, .pixel_mm = 4});
  const std::vector<Receiver> receivers(100, {{0, 0, 900}, {0, 0, -1}});
  // By the caller's thread, by the other, and while the form is made.
  for (const std::uint32_t from : {0U, 70U, 1000U}) {
    HostEvaluation evaluation(field.geometry(), {.method = Method::reference},
                              [&](const LightField&, const MethodSettings&) -> Result<std::unique_ptr<HostMethod>> {
                                if (from == 1000) throw std::bad_alloc();
                                return std::make_unique<ThrowingForm>(from);
                              });
    ASSERT_TRUE(evaluation.set_cells(field));
    ASSERT_TRUE(evaluation.set_receivers(receivers));
    const auto done = evaluation.evaluate(HUGE_VAL);
    ASSERT_FALSE(done);
    EXPECT_EQ(done.error().where, "host, double precision");
    std::vector<double> e;
    ASSERT_TRUE(evaluation.read(e));
    EXPECT_EQ(e, std::vector<double>(100, 0.0)) << "nothing is left of an evaluation that failed";
  }
}

}  // namespace
}  // namespace lumifield
