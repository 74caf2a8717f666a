#include <cmath>
#include <gtest/gtest.h>
#include <optional>
#include <random>

#include "renderer/methods/closed_form.h"
#include "renderer/study/definition_quadrature.h"
#include "tests/support/closed_form_cases.h"
#include "tests/support/coarse_luminaires.h"

namespace lumifield {
namespace {

struct Cells {
  std::vector<CellIndex> indices;
  std::vector<std::shared_ptr<const CellImage>> kept;
  std::vector<const CellImage*> images;

  explicit Cells(const LightField& field) {
    const Sampling& sampling = field.geometry().sampling;
    for (int flat = 0; flat < sampling.cells(); ++flat)
      if (auto image = field.cell(sampling.index(flat))) {
        indices.push_back(sampling.index(flat));
        images.push_back(image.get());
        kept.push_back(std::move(image));
      }
  }
};

class LevelOfDetailDeviceOf : public testing::TestWithParam<std::tuple<BasisKind, int>> {
 protected:
  void SetUp() override {
    const auto [basis, channels] = GetParam();
    field_.emplace(whole_numbers(random_luminaire(basis, channels, 51)));
    auto created = ClosedFormDevice::create(field_->geometry());
    if (!created) GTEST_SKIP() << created.error().message();
    device_ = std::move(*created);
    cases_ = receiver_cases(field_->geometry(), 52);
    for (const ReceiverCase& each : cases_) receivers_.push_back({each.p_mm, each.n});
  }

  /// Sums of all cells at this level of detail.
  std::vector<double> sums(double lod, const Cells& cells) {
    EXPECT_TRUE(device_->set_lod(lod));
    EXPECT_TRUE(device_->set_receivers(receivers_));
    EXPECT_TRUE(device_->add_cells(cells.indices, cells.images));
    return read();
  }
  std::vector<double> read() {
    std::vector<double> sums;
    EXPECT_TRUE(device_->read(sums));
    return sums;
  }
  /// ∫|C̄ Φ| of each sum, what an error is measured against.
  std::vector<double> magnitudes(const LightField& field, double lod) const {
    std::vector<LightField> means;
    for (int level = 0; level <= 6; ++level) means.push_back(mean_luminaire(field, level));
    std::vector<double> all;
    for (const ReceiverCase& each : cases_) {
      const int level = expected_level(field.geometry(), each.p_mm.z(), lod);
      const DefinitionValue value = definition_quadrature(means[std::size_t(level)], each.p_mm, each.n);
      all.insert(all.end(), value.magnitude.begin(), value.magnitude.end());
    }
    return all;
  }
  const ReceiverCase& case_of(std::size_t sum) const { return cases_[sum / field_->geometry().channels.size()]; }

  std::optional<LightField> field_;
  std::unique_ptr<ClosedFormDevice> device_;
  std::vector<ReceiverCase> cases_;
  std::vector<Receiver> receivers_;
};
std::string name_of(const testing::TestParamInfo<std::tuple<BasisKind, int>>& each) {
  return std::string(to_string(std::get<0>(each.param))) + std::to_string(std::get<1>(each.param));
}
INSTANTIATE_TEST_SUITE_P(All, LevelOfDetailDeviceOf,
                         testing::Values(std::tuple(BasisKind::box, 1), std::tuple(BasisKind::tent, 1),
                                         std::tuple(BasisKind::bell, 1), std::tuple(BasisKind::bspline2, 1),
                                         std::tuple(BasisKind::bell, 3)),
                         name_of);

/// The host is checked against the definition.
TEST_P(LevelOfDetailDeviceOf, EqualsTheHost) {
  const Cells cells(*field_);
  for (double lod : {12.0, 8.0, 4.0, 2.5, 0.7}) {
    const ClosedForm host(*field_, lod);
    const std::vector<double> e = sums(lod, cells), magnitude = magnitudes(*field_, lod);
    const std::size_t channels = field_->geometry().channels.size();
    for (std::size_t k = 0; k < e.size(); ++k) {
      const double expected = host.irradiance(receivers_[k / channels])[k % channels];
      EXPECT_LE(std::abs(e[k] - expected), 1e-5 * magnitude[k])
          << case_of(k).name << ", T = " << lod << ", p " << case_of(k).p_mm.transpose();
    }
  }
}

TEST_P(LevelOfDetailDeviceOf, AllPixelsAreExact) {
  const Cells cells(*field_);
  const std::vector<double> exact = sums(0, cells);
  EXPECT_EQ(sums(1e300, cells), exact);
  EXPECT_NE(sums(2, cells), exact);
}

TEST_P(LevelOfDetailDeviceOf, TakesEffectWithTheNextReceivers) {
  const Cells cells(*field_);
  const std::vector<double> exact = sums(0, cells), coarse = sums(2, cells);
  ASSERT_TRUE(device_->set_receivers(receivers_));
  ASSERT_TRUE(device_->set_lod(0));
  ASSERT_TRUE(device_->add_cells(cells.indices, cells.images));
  EXPECT_EQ(read(), coarse);
  ASSERT_TRUE(device_->set_receivers(receivers_));
  ASSERT_TRUE(device_->add_cells(cells.indices, cells.images));
  EXPECT_EQ(read(), exact);
}

TEST_P(LevelOfDetailDeviceOf, CellsInSlicesSumToTheSame) {
  const Cells cells(*field_);
  const std::vector<double> together = sums(3, cells), magnitude = magnitudes(*field_, 3);
  for (std::size_t slice : {std::size_t(1), std::size_t(2), std::size_t(5)}) {
    ASSERT_TRUE(device_->set_receivers(receivers_));
    for (std::size_t k = 0; k < cells.indices.size(); k += slice) {
      const std::size_t n = std::min(slice, cells.indices.size() - k);
      ASSERT_TRUE(device_->add_cells(std::span(cells.indices).subspan(k, n), std::span(cells.images).subspan(k, n)));
    }
    const std::vector<double> apart = read();
    for (std::size_t k = 0; k < apart.size(); ++k)
      EXPECT_LE(std::abs(apart[k] - together[k]), 1e-12 * magnitude[k]) << case_of(k).name << ", slices of " << slice;
  }
}

TEST_P(LevelOfDetailDeviceOf, ARetakenCellLeavesNoTrace) {
  const LightField other = whole_numbers(
      random_luminaire(field_->geometry().sampling.basis, static_cast<int>(field_->geometry().channels.size()), 99));
  const Cells before(other), after(*field_);
  const std::vector<double> fresh = sums(3, after);
  sums(3, before);
  for (std::size_t k = 0; k < after.indices.size(); ++k)
    ASSERT_TRUE(device_->add_cell(after.indices[k], *after.images[k], before.images[k]));
  const std::vector<double> retaken = read();
  const std::vector<double> magnitude = magnitudes(*field_, 3), other_magnitude = magnitudes(other, 3);
  for (std::size_t k = 0; k < fresh.size(); ++k)
    EXPECT_LE(std::abs(retaken[k] - fresh[k]), 1e-12 * (magnitude[k] + other_magnitude[k])) << case_of(k).name;
}

/// Rows of more cells than are summed at once, some of them beside the image, some cut by the horizon or below it.
TEST(LevelOfDetailDevice, LongRowsEqualTheHost) {
  LuminaireGeometry g;
  g.planes.separation_mm = 40;
  g.sampling = {BasisKind::bell, {6, 6}, 11, 2, {3, 1}};
  g.measurement = {70, 60, {1, 1}, {2, -3}};
  g.channels = {"Y"};
  LightField field(g);
  std::mt19937 random(61);
  std::uniform_real_distribution<float> value(0, 1);
  for (int flat = 0; flat < 22; ++flat) {
    if (flat == 5 || flat == 16) continue;
    CellImage image{70, 60, 1, std::vector<float>(4200), {}, {}};
    for (float& v : image.value) v = value(random);
    ASSERT_TRUE(field.add(g.sampling.index(flat), std::move(image)));
  }
  auto device = ClosedFormDevice::create(g);
  if (!device) GTEST_SKIP() << device.error().message();
  std::uniform_real_distribution<double> unit(-1, 1);
  std::vector<Receiver> receivers;
  for (int k = 0; k < 400; ++k) {
    const double z = k % 2 == 0 ? 25 + 10 * unit(random) : 120 + 70 * unit(random);
    const Vec3 n = k % 4 == 0 ? Vec3(unit(random), unit(random), 0.3 * unit(random)) : Vec3(0.2 * unit(random), 0, -1);
    receivers.push_back({{z * unit(random), 0.7 * z * unit(random), z}, n.normalized()});
  }
  const Cells cells(field);
  for (double lod : {8.0, 5.0, 3.0}) {
    const ClosedForm host(field, lod);
    ASSERT_TRUE((*device)->set_lod(lod));
    ASSERT_TRUE((*device)->set_receivers(receivers));
    ASSERT_TRUE((*device)->add_cells(cells.indices, cells.images));
    std::vector<double> e;
    ASSERT_TRUE((*device)->read(e));
    for (std::size_t k = 0; k < e.size(); ++k) {
      // The images are positive: E is its own magnitude.
      const double expected = host.irradiance(receivers[k])[0];
      EXPECT_LE(std::abs(e[k] - expected), 1e-5 * expected) << "T = " << lod << ", p " << receivers[k].p_mm.transpose();
    }
  }
}

/// A grid of more rows and columns than are summed at once, its supports of a few pixels to some dozens, some cut by
/// the horizon or below it, a cell missing here and there.
TEST(LevelOfDetailDevice, LargeGridsEqualTheHost) {
  for (const BasisKind basis : {BasisKind::bell, BasisKind::bspline2}) {
    LuminaireGeometry g;
    g.planes.separation_mm = 40;
    g.sampling = {basis, {5, 6}, 19, 18, {3, 1}};
    g.measurement = {70, 60, {1, 0.75}, {2, -3}};
    g.channels = {"R", "G", "B"};
    LightField field(g);
    std::mt19937 random(71);
    std::uniform_real_distribution<float> value(0, 1);
    for (int flat = 0; flat < g.sampling.cells(); ++flat) {
      if (flat % 11 == 5) continue;
      CellImage image{70, 60, 3, std::vector<float>(12600), {}, {}};
      for (float& v : image.value) v = value(random);
      ASSERT_TRUE(field.add(g.sampling.index(flat), std::move(image)));
    }
    auto device = ClosedFormDevice::create(g);
    if (!device) GTEST_SKIP() << device.error().message();
    std::uniform_real_distribution<double> unit(-1, 1);
    std::vector<Receiver> receivers;
    for (int k = 0; k < 50; ++k) {
      const double z = k % 3 == 0   ? 12 + 8 * unit(random)
                       : k % 3 == 1 ? 40 + 10 * unit(random)
                                    : 400 + 200 * unit(random);
      const Vec3 n =
          k % 5 == 0 ? Vec3(unit(random), unit(random), 0.3 * unit(random)) : Vec3(0.2 * unit(random), 0, -1);
      receivers.push_back({{z * unit(random), 0.7 * z * unit(random), z}, n.normalized()});
    }
    const Cells cells(field);
    for (double lod : {0.0, 8.0, 3.0}) {
      const ClosedForm host(field, lod);
      ASSERT_TRUE((*device)->set_lod(lod));
      ASSERT_TRUE((*device)->set_receivers(receivers));
      ASSERT_TRUE((*device)->add_cells(cells.indices, cells.images));
      std::vector<double> e;
      ASSERT_TRUE((*device)->read(e));
      for (std::size_t k = 0; k < e.size(); ++k) {
        // The images are positive: E is its own magnitude.
        const double expected = host.irradiance(receivers[k / 3])[k % 3];
        EXPECT_LE(std::abs(e[k] - expected), 1e-5 * expected)
            << to_string(basis) << ", T = " << lod << ", p " << receivers[k / 3].p_mm.transpose();
      }
    }
  }
}

}  // namespace
}  // namespace lumifield
