#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <gtest/gtest.h>
#include <limits>
#include <map>
#include <numeric>

#include "renderer/methods/closed_form.h"
#include "renderer/study/definition_quadrature.h"
#include "tests/support/closed_form_cases.h"

namespace lumifield {
namespace {

struct Cells {
  std::vector<CellIndex> indices;
  std::vector<std::shared_ptr<const CellImage>> kept;
  std::vector<const CellImage*> images;
};

Cells cells_of(const LightField& field) {
  Cells cells;
  const Sampling& sampling = field.geometry().sampling;
  for (int flat = 0; flat < sampling.cells(); ++flat)
    if (auto image = field.cell(sampling.index(flat))) {
      cells.indices.push_back(sampling.index(flat));
      cells.images.push_back(image.get());
      cells.kept.push_back(std::move(image));
    }
  return cells;
}

std::vector<double> sums_of(ClosedFormDevice& device) {
  std::vector<double> sums;
  EXPECT_TRUE(device.read(sums));
  return sums;
}

class ClosedFormDeviceOf : public testing::TestWithParam<std::tuple<BasisKind, int>> {
 protected:
  void SetUp() override {
    const auto [basis, channels] = GetParam();
    field_.emplace(random_luminaire(basis, channels, 21));
    auto created = ClosedFormDevice::create(field_->geometry());
    if (!created) GTEST_SKIP() << created.error().message();
    device_ = std::move(*created);
    cases_ = receiver_cases(field_->geometry(), 22);
    for (const ReceiverCase& each : cases_) receivers_.push_back({each.p_mm, each.n});
    ASSERT_TRUE(device_->set_receivers(receivers_));
  }
  std::optional<LightField> field_;
  std::unique_ptr<ClosedFormDevice> device_;
  std::vector<ReceiverCase> cases_;
  std::vector<Receiver> receivers_;
};
std::string name_of(const testing::TestParamInfo<std::tuple<BasisKind, int>>& each) {
  return std::string(to_string(std::get<0>(each.param))) + std::to_string(std::get<1>(each.param));
}

INSTANTIATE_TEST_SUITE_P(All, ClosedFormDeviceOf,
                         testing::Values(std::tuple(BasisKind::box, 1), std::tuple(BasisKind::tent, 1),
                                         std::tuple(BasisKind::bell, 1), std::tuple(BasisKind::bspline2, 1),
                                         std::tuple(BasisKind::bell, 3)),
                         name_of);

/// What holds of the running sums, whatever the basis.
class ClosedFormDeviceSums : public ClosedFormDeviceOf {};
INSTANTIATE_TEST_SUITE_P(All, ClosedFormDeviceSums,
                         testing::Values(std::tuple(BasisKind::bell, 1), std::tuple(BasisKind::bell, 3)), name_of);

TEST_P(ClosedFormDeviceOf, EqualsTheDefinition) {
  const Cells cells = cells_of(*field_);
  ASSERT_TRUE(device_->add_cells(cells.indices, cells.images));
  const std::vector<double> e = sums_of(*device_);
  const std::size_t channels = field_->geometry().channels.size();
  ASSERT_EQ(e.size(), cases_.size() * channels);
  std::map<std::string, double> worst;
  for (std::size_t k = 0; k < cases_.size(); ++k) {
    const ReceiverCase& each = cases_[k];
    const DefinitionValue expected = definition_quadrature(*field_, each.p_mm, each.n);
    for (std::size_t c = 0; c < channels; ++c) {
      const double error = std::abs(e[k * channels + c] - expected.irradiance[c]);
      EXPECT_LE(error, 1e-5 * expected.magnitude[c])
          << each.name << " p " << each.p_mm.transpose() << " n " << each.n.transpose();
      if (expected.magnitude[c] > 0) worst[each.name] = std::max(worst[each.name], error / expected.magnitude[c]);
    }
  }
  if (std::getenv("LUMIFIELD_PRINT_ERRORS"))
    for (const auto& [name, error] : worst) std::printf("%-24s %.1e\n", name.c_str(), error);
}

TEST_P(ClosedFormDeviceSums, CellsOneByOneSumToTheSame) {
  const Cells cells = cells_of(*field_);
  ASSERT_TRUE(device_->add_cells(cells.indices, cells.images));
  const std::vector<double> together = sums_of(*device_);
  ASSERT_TRUE(device_->set_receivers(receivers_));
  for (std::size_t k = cells.indices.size(); k-- > 0;)
    ASSERT_TRUE(device_->add_cell(cells.indices[k], *cells.images[k]));
  const std::vector<double> apart = sums_of(*device_);
  const std::size_t channels = field_->geometry().channels.size();
  for (std::size_t k = 0; k < apart.size(); ++k) {
    const ReceiverCase& each = cases_[k / channels];
    const double magnitude = definition_quadrature(*field_, each.p_mm, each.n).magnitude[k % channels];
    EXPECT_LE(std::abs(apart[k] - together[k]), 1e-12 * magnitude) << each.name;
  }
}

TEST_P(ClosedFormDeviceSums, ImagesThatAreHeldStayOnTheDevice) {
  const Cells cells = cells_of(*field_);
  const auto changed = std::make_shared<CellImage>(*cells.kept[0]);
  const auto sums = [&](const std::vector<std::shared_ptr<const CellImage>>& images) {
    EXPECT_TRUE(device_->set_receivers(receivers_));
    EXPECT_TRUE(device_->add_cells(cells.indices, images));
    return sums_of(*device_);
  };
  std::vector<std::shared_ptr<const CellImage>> held = cells.kept;
  const std::vector<double> exact = sums(held);
  held[0] = changed;
  EXPECT_EQ(sums(held), exact);
  // Nobody may change one that is held: here it shows that it is not uploaded again, with other receivers neither.
  for (float& v : changed->value) v *= 2;
  EXPECT_EQ(sums(held), exact);
  // Others are: an image by itself, another one, all of them at another level of detail.
  held[0] = std::make_shared<CellImage>(*changed);
  const std::vector<double> doubled = sums(held);
  EXPECT_NE(doubled, exact);
  ASSERT_TRUE(device_->add_cell(cells.indices[1], *cells.images[1]));
  EXPECT_EQ(sums(held), doubled);
  for (const double lod : {8.0, 0.0}) {
    ASSERT_TRUE(device_->set_lod(lod));
    EXPECT_EQ(sums(held) == doubled, lod == 0);
  }
  EXPECT_EQ(sums(cells.kept), exact);
}

TEST_P(ClosedFormDeviceSums, ARetakenCellLeavesNoTrace) {
  const LightField other =
      random_luminaire(field_->geometry().sampling.basis, static_cast<int>(field_->geometry().channels.size()), 99);
  const Cells before = cells_of(other), after = cells_of(*field_);
  ASSERT_TRUE(device_->add_cells(after.indices, after.images));
  const std::vector<double> fresh = sums_of(*device_);
  ASSERT_TRUE(device_->set_receivers(receivers_));
  ASSERT_TRUE(device_->add_cells(before.indices, before.images));
  for (std::size_t k = 0; k < after.indices.size(); ++k)
    ASSERT_TRUE(device_->add_cell(after.indices[k], *after.images[k], before.images[k]));
  const std::vector<double> retaken = sums_of(*device_);
  const std::size_t channels = field_->geometry().channels.size();
  for (std::size_t k = 0; k < fresh.size(); ++k) {
    const ReceiverCase& each = cases_[k / channels];
    const double magnitude = definition_quadrature(*field_, each.p_mm, each.n).magnitude[k % channels] +
                             definition_quadrature(other, each.p_mm, each.n).magnitude[k % channels];
    EXPECT_LE(std::abs(retaken[k] - fresh[k]), 1e-12 * magnitude) << each.name;
  }
}

TEST(ClosedFormDevice, FloatReceiversEqualTheHost) {
  const LightField field = random_luminaire(BasisKind::bell, 3, 31);
  auto device = ClosedFormDevice::create(field.geometry());
  if (!device) GTEST_SKIP() << device.error().message();
  // A tilted plane of receivers, every fifth background, as a picture hands them over.
  std::vector<float> p, n;
  for (int k = 0; k < 500; ++k) {
    p.insert(p.end(), {float(k % 25) * 2 - 25, float(k / 25) * 3 - 30, 90 + float(k % 7), 1});
    const float facing = k % 5 == 0 ? 0.0f : -1.0f;
    n.insert(n.end(), {0, 0, facing, 0});
  }
  const Cells cells = cells_of(field);
  ASSERT_TRUE((*device)->set_receivers(p, n));
  ASSERT_TRUE((*device)->add_cells(cells.indices, cells.images));
  std::vector<float> e;
  ASSERT_TRUE((*device)->read(e));
  const ClosedForm host(field);
  for (std::size_t k = 0; k < 500; ++k) {
    const Vec3 at(p[4 * k], p[4 * k + 1], p[4 * k + 2]);
    const std::vector<double> expected = host.irradiance({at, {0, 0, n[4 * k + 2]}});
    const DefinitionValue value = definition_quadrature(field, at, {0, 0, n[4 * k + 2]});
    for (std::size_t c = 0; c < 3; ++c)
      EXPECT_LE(std::abs(e[3 * k + c] - expected[c]), 1e-5 * value.magnitude[c]) << at.transpose();
  }
}

TEST(ClosedFormDevice, RefusesWhatItCannotUse) {
  const LightField field = random_luminaire(BasisKind::box, 1, 1);
  LuminaireGeometry two = field.geometry();
  two.channels = {"a", "b"};
  EXPECT_FALSE(ClosedFormDevice::create(two));
  LuminaireGeometry huge = field.geometry();
  huge.measurement.width_px = huge.measurement.height_px = 1 << 30;
  EXPECT_FALSE(ClosedFormDevice::create(huge));

  auto device = ClosedFormDevice::create(field.geometry());
  if (!device) GTEST_SKIP() << device.error().message();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<Receiver> bad{{{0, 0, 1}, {0, 0, 1}}, {{0, nan, 1}, {0, 0, 1}}};
  const Status refused = (*device)->set_receivers(bad);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().where, "receiver 1");
  EXPECT_FALSE((*device)->set_receivers(std::vector<float>(8), std::vector<float>(4)));

  CellImage image = *cells_of(field).images[0];
  EXPECT_FALSE((*device)->add_cell({9, 9}, image));
  image.value[5] = std::numeric_limits<float>::infinity();
  const Status infinite = (*device)->add_cell({1, 2}, image);
  ASSERT_FALSE(infinite);
  EXPECT_EQ(infinite.error().where, "cell (1, 2): channel Y: pixel (5, 0)");
  image.value.pop_back();
  EXPECT_FALSE((*device)->add_cell({1, 2}, image));
}

TEST(ClosedFormDevice, RefusesALevelOfDetailThatIsNone) {
  auto device = ClosedFormDevice::create(random_luminaire(BasisKind::box, 1, 1).geometry());
  if (!device) GTEST_SKIP() << device.error().message();
  for (double lod :
       {-1.0, -1e-300, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    const Status refused = (*device)->set_lod(lod);
    ASSERT_FALSE(refused) << lod;
    EXPECT_EQ(refused.error().where, "level of detail");
  }
  for (double lod : {0.0, 1e-300, 4.0, 1e300}) EXPECT_TRUE((*device)->set_lod(lod)) << lod;
}

TEST(ClosedFormDevice, WithoutReceiversThereIsNothingToDo) {
  const LightField field = random_luminaire(BasisKind::box, 1, 1);
  auto device = ClosedFormDevice::create(field.geometry());
  if (!device) GTEST_SKIP() << device.error().message();
  const Cells cells = cells_of(field);
  EXPECT_TRUE((*device)->set_receivers(std::span<const Receiver>()));
  EXPECT_TRUE((*device)->add_cells(cells.indices, cells.images));
  EXPECT_TRUE(sums_of(**device).empty());
}

TEST_P(ClosedFormDeviceSums, WhatIsNotFiniteIsRefusedOnEachAxis) {
  for (const double bad : {HUGE_VAL, -HUGE_VAL, std::nan("")})
    for (int axis = 0; axis < 3; ++axis) {
      Receiver p{{1, 2, 300}, {0, 0, -1}}, n = p;
      p.p_mm[axis] = bad;
      n.n[axis] = bad;
      EXPECT_FALSE(device_->set_receivers(std::vector{p})) << bad << ", axis " << axis;
      EXPECT_FALSE(device_->set_receivers(std::vector{n})) << bad << ", axis " << axis;
    }
}

TEST_P(ClosedFormDeviceSums, TheLightStaysHoweverNearAReceiverIsToTheFilter) {
  const ClosedForm host(*field_);
  std::vector<Receiver> near;
  for (const double z : {1e-7, 1e-9, 1e-12, 1e-20, 1e-40, 1e-103, 1e-200, 4.9e-324})
    near.push_back({{1, -2, z}, {0, 0.6, -0.8}});
  const Cells cells = cells_of(*field_);
  ASSERT_TRUE(device_->set_receivers(near));
  ASSERT_TRUE(device_->add_cells(cells.indices, cells.images));
  const std::vector<double> sums = sums_of(*device_), expected = host.irradiance(near[0]);
  for (std::size_t k = 0; k < near.size(); ++k)
    for (std::size_t c = 0; c < expected.size(); ++c) {
      EXPECT_GT(std::abs(expected[c]), 0);
      EXPECT_NEAR(host.irradiance(near[k])[c], expected[c], 1e-6 * std::abs(expected[c])) << k;
      EXPECT_NEAR(sums[k * expected.size() + c], expected[c], 1e-5 * std::abs(expected[c])) << k;
    }
}

}  // namespace
}  // namespace lumifield
