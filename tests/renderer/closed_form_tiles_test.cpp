#include "renderer/methods/closed_form_tiles.h"

#include <cmath>
#include <gtest/gtest.h>
#include <map>
#include <random>

#include "renderer/methods/closed_form.h"
#include "renderer/methods/gloss.h"
#include "tests/support/closed_form_cases.h"

namespace lumifield {
namespace {

/// Bits of many kinds, from nothing seen to everything.
TileVisibility random_visibility(const Sampling& sampling, std::size_t receivers, ShadowWeighing weighing) {
  TileVisibility visible{TileGrid(sampling), weighing, {}};
  std::mt19937 random(5);
  visible.words.assign(receivers * visible.receiver_words(), 0);
  for (std::size_t k = 0; k < receivers; ++k) {
    const double share = static_cast<double>(random() % 5) / 4;
    for (int row = 0; row < visible.grid.rows; ++row)
      for (int column = 0; column < visible.grid.columns; ++column)
        if (std::generate_canonical<double, 53>(random) < share)
          visible.words[k * visible.receiver_words() + static_cast<std::size_t>(row) * visible.row_words() +
                        static_cast<std::size_t>(column / 32)] |= 1U << (column % 32);
  }
  return visible;
}

ClosedForm::Share share_of(const TileVisibility& visible, std::size_t receiver, int division) {
  return [&visible, receiver, division](CellIndex cell, int column, int row) {
    return visible.share(receiver, cell, column / division, row / division);
  };
}

LightField absolute(const LightField& field) {
  LightField result(field.geometry());
  for (int flat = 0; flat < field.geometry().sampling.cells(); ++flat) {
    const auto image = field.cell(field.geometry().sampling.index(flat));
    if (!image) continue;
    CellImage positive = *image;
    for (float& v : positive.value) v = std::abs(v);
    EXPECT_TRUE(result.add(field.geometry().sampling.index(flat), std::move(positive)));
  }
  return result;
}

/// Lobes whose eye is on the normal's side, of every kind and sharpness; every third receiver is diffuse.
std::vector<GlossLobe> random_lobes(const std::vector<Receiver>& receivers, bool coloured) {
  std::vector<GlossLobe> lobes;
  std::mt19937 random(6);
  const auto unit = [&] { return std::generate_canonical<float, 24>(random); };
  for (std::size_t k = 0; k < receivers.size(); ++k) {
    Vec3 eye = Vec3(unit() - 0.5, unit() - 0.5, unit() - 0.5).normalized();
    if (eye.dot(receivers[k].n) < 0) eye = -eye;
    GlossLobe lobe{
        static_cast<float>(eye.x()), static_cast<float>(eye.y()), static_cast<float>(eye.z()), 0, 0.5F, 0.5F, 0.5F,
        static_cast<int>(k % 3)};
    if (coloured) lobe.g = unit();
    lobe.shape = lobe.kind == LOBE_PHONG ? 1 + 80 * unit() : 0.05F + unit() * 0.9F;
    lobes.push_back(lobe);
  }
  return lobes;
}

/// About the most that a lobe reflects of the light from any side, 1/sr.
double peak_of(const GlossLobe& lobe) {
  const double shape = lobe.shape;
  return lobe.kind == LOBE_PHONG ? (shape + 2) / 6 : 1 / (4 * shape * shape);
}

class ClosedFormTilesOf : public testing::TestWithParam<std::tuple<BasisKind, int>> {
 protected:
  void SetUp() override {
    const auto [basis, channels] = GetParam();
    field_.emplace(random_luminaire(basis, channels, 21));
    form_.emplace(*field_);
    magnitude_.emplace(absolute(*field_));
    int number = 0;
    for (const ReceiverCase& each : receiver_cases(field_->geometry(), 22)) {
      if (number++ % 3 != 0) continue;  // splitting takes long on the host
      cases_.push_back(each);
      receivers_.push_back({each.p_mm, each.n});
    }
  }
  std::size_t channels() const { return field_->geometry().channels.size(); }
  std::string name(std::size_t k) const {
    std::ostringstream text;
    text << cases_[k].name << " p " << cases_[k].p_mm.transpose() << " n " << cases_[k].n.transpose();
    return text.str();
  }
  void expect_as_host(const Appearance& appearance, double tolerance, double lod = 0);

  std::optional<LightField> field_;
  std::optional<ClosedForm> form_, magnitude_;
  std::vector<ReceiverCase> cases_;
  std::vector<Receiver> receivers_;
};
INSTANTIATE_TEST_SUITE_P(All, ClosedFormTilesOf,
                         testing::Values(std::tuple(BasisKind::box, 1), std::tuple(BasisKind::tent, 1),
                                         std::tuple(BasisKind::bell, 1), std::tuple(BasisKind::bspline2, 1),
                                         std::tuple(BasisKind::bell, 3)),
                         [](const auto& each) {
                           return std::string(to_string(std::get<0>(each.param))) +
                                  std::to_string(std::get<1>(each.param));
                         });

TEST_P(ClosedFormTilesOf, AllSubtilesTogetherAreTheWhole) {
  const auto all = [](CellIndex, int, int) { return 1.0; };
  for (std::size_t k = 0; k < receivers_.size(); k += 3) {
    const std::vector<double> whole = form_->irradiance(receivers_[k]), light = magnitude_->irradiance(receivers_[k]);
    for (const int division : {1, 2, 4}) {
      const ClosedForm::Light split = form_->light(receivers_[k], {}, all, division);
      for (std::size_t c = 0; c < channels(); ++c)
        EXPECT_LE(std::abs(split.irradiance[c] - whole[c]), 1e-9 * light[c]) << name(k) << " division " << division;
    }
  }
}

TEST_P(ClosedFormTilesOf, TheSubtilesOfATileAreTheTile) {
  const TileVisibility visible =
      random_visibility(field_->geometry().sampling, receivers_.size(), ShadowWeighing::tile);
  for (std::size_t k = 0; k < receivers_.size(); k += 5) {
    const ClosedForm::Light tiles = form_->light(receivers_[k], {}, share_of(visible, k, 1), 1);
    const ClosedForm::Light finer = form_->light(receivers_[k], {}, share_of(visible, k, 2), 2);
    const std::vector<double> light = magnitude_->irradiance(receivers_[k]);
    for (std::size_t c = 0; c < channels(); ++c)
      EXPECT_LE(std::abs(tiles.irradiance[c] - finer.irradiance[c]), 1e-9 * light[c]) << name(k);
  }
}

/// A quarter of the error where subtiles are half as wide.
TEST_P(ClosedFormTilesOf, GlossConvergesWithTheSquareOfTheSubtiles) {
  const auto all = [](CellIndex, int, int) { return 1.0; };
  const LuminaireGeometry& g = field_->geometry();
  const Receiver receiver{{5, -8, 3 * g.planes.separation_mm}, Vec3(0.1, 0.2, -1).normalized()};
  const Vec3 eye = Vec3(-0.1, 0.3, -1).normalized();
  const GlossLobe lobe{static_cast<float>(eye.x()),
                       static_cast<float>(eye.y()),
                       static_cast<float>(eye.z()),
                       0.3F,
                       0.04F,
                       0.04F,
                       0.04F,
                       LOBE_GGX};
  std::vector<double> at;
  for (const int division : {1, 2, 4, 8}) at.push_back(magnitude_->light(receiver, lobe, all, division).gloss[0]);
  for (const double a : at) std::printf("%.8g\n", a);
  const double first = std::abs(at[0] - at[1]), second = std::abs(at[1] - at[2]), third = std::abs(at[2] - at[3]);
  EXPECT_GT(first, 0);
  EXPECT_NEAR(first / second, 4, 1.2);
  EXPECT_NEAR(second / third, 4, 1.2);
}

void ClosedFormTilesOf::expect_as_host(const Appearance& appearance, double tolerance, double lod) {
  auto created = ClosedFormDevice::create(field_->geometry());
  if (!created) GTEST_SKIP() << created.error().message();
  ClosedFormDevice& device = **created;
  ASSERT_TRUE(device.set_lod(lod));
  ASSERT_TRUE(device.set_receivers(receivers_, appearance));
  const Sampling& sampling = field_->geometry().sampling;
  for (int flat = 0; flat < sampling.cells(); ++flat)
    if (const auto image = field_->cell(sampling.index(flat))) {
      ASSERT_TRUE(device.add_cell(sampling.index(flat), *image));
    }
  std::vector<double> e, gloss;
  ASSERT_TRUE(device.read(e));
  const Status read = device.read_gloss(gloss);
  ASSERT_TRUE(read) << read.error().message();
  const std::size_t outs = appearance.gloss_channels(channels());
  ASSERT_EQ(gloss.size(), outs * receivers_.size());

  const ClosedForm form(*field_, lod), magnitude(absolute(*field_), lod);
  const TileGrid grid(sampling);
  std::map<std::string, double> worst;
  for (std::size_t k = 0; k < receivers_.size(); ++k) {
    const GlossLobe lobe = appearance.gloss.empty() ? GlossLobe{} : appearance.gloss[k];
    const int division = gloss_division(grid, receivers_[k], lobe);
    const auto share = appearance.visible.empty() ? [](CellIndex, int, int) { return 1.0; }
                                                  : share_of(appearance.visible, k, division);
    const ClosedForm::Light host = form.light(receivers_[k], lobe, share, division);
    const ClosedForm::Light light = magnitude.light(
        receivers_[k], lobe, [](CellIndex, int, int) { return 1.0; }, division);
    for (std::size_t c = 0; c < channels(); ++c) {
      const double off = std::abs(e[k * channels() + c] - host.irradiance[c]);
      EXPECT_LE(off, tolerance * light.irradiance[c]) << name(k);
      if (light.irradiance[c] > 0)
        worst["E " + cases_[k].name] = std::max(worst["E " + cases_[k].name], off / light.irradiance[c]);
    }
    for (std::size_t c = 0; c < (lobe.kind == LOBE_NONE ? 0 : outs); ++c) {
      const std::size_t at = c % host.gloss.size();
      const double off = std::abs(gloss[k * outs + c] - host.gloss[at]);
      // The lobe is in float: of its peak, which the tail may be far below.
      const double allowed = 1e-6 * peak_of(lobe) * light.irradiance[c % channels()] + tolerance * light.gloss[at];
      EXPECT_LE(off, allowed) << "gloss of " << name(k) << " division " << division << " kind " << lobe.kind
                              << " shape " << lobe.shape;
      if (light.gloss[at] > 0)
        worst["G " + cases_[k].name] = std::max(worst["G " + cases_[k].name], off / light.gloss[at]);
    }
  }
  if (std::getenv("LUMIFIELD_PRINT_ERRORS"))
    for (const auto& [which, error] : worst) std::printf("%-24s %.1e\n", which.c_str(), error);
}

TEST_P(ClosedFormTilesOf, KernelSeesTheTilesThatTheHostSees) {
  expect_as_host({{}, random_visibility(field_->geometry().sampling, receivers_.size(), ShadowWeighing::tile)}, 1e-5);
}

TEST_P(ClosedFormTilesOf, KernelWeighsByTheMeanAsTheHost) {
  expect_as_host({{}, random_visibility(field_->geometry().sampling, receivers_.size(), ShadowWeighing::mean)}, 1e-5);
}

TEST_P(ClosedFormTilesOf, KernelShinesAsTheHost) { expect_as_host({random_lobes(receivers_, false), {}}, 1e-4); }

TEST_P(ClosedFormTilesOf, KernelShinesInColourAndHalfShadowAsTheHost) {
  expect_as_host({random_lobes(receivers_, true),
                  random_visibility(field_->geometry().sampling, receivers_.size(), ShadowWeighing::tile)},
                 1e-4);
}

TEST_P(ClosedFormTilesOf, KernelKeepsToALevelOfDetail) {
  expect_as_host({random_lobes(receivers_, true),
                  random_visibility(field_->geometry().sampling, receivers_.size(), ShadowWeighing::tile)},
                 1e-4, 6);
}

}  // namespace
}  // namespace lumifield
