#include "renderer/methods/closed_form_tiles.h"

#include <cmath>
#include <gtest/gtest.h>
#include <map>

#include "renderer/methods/closed_form.h"
#include "renderer/methods/gloss.h"
#include "tests/support/closed_form_cases.h"
#include "tests/support/random_looks.h"

namespace lumifield {
namespace {

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
  for (std::size_t k = 0; k < receivers_.size(); k += 3) {
    const std::vector<double> whole = form_->irradiance(receivers_[k]), light = magnitude_->irradiance(receivers_[k]);
    for (const int division : {0, 1, 2, 4}) {
      const std::vector<double> split = form_->light(receivers_[k], {}, division);
      for (std::size_t c = 0; c < channels(); ++c)
        EXPECT_LE(std::abs(split[c] - whole[c]), 1e-9 * light[c]) << name(k) << " division " << division;
    }
  }
}

TEST_P(ClosedFormTilesOf, TheSubtilesOfATileAreTheTile) {
  const TileVisibility visible =
      test::random_visibility(field_->geometry().sampling, receivers_.size(), ShadowWeighing::tile);
  for (std::size_t k = 0; k < receivers_.size(); k += 5) {
    const Look look{{}, &visible, k, {}};
    const std::vector<double> tiles = form_->light(receivers_[k], look, 1),
                              finer = form_->light(receivers_[k], look, 2);
    const std::vector<double> light = magnitude_->irradiance(receivers_[k]);
    for (std::size_t c = 0; c < channels(); ++c) EXPECT_LE(std::abs(tiles[c] - finer[c]), 1e-9 * light[c]) << name(k);
  }
}

/// A quarter of the error where subtiles are half as wide; of even light, so that no pixel counts for all.
TEST_P(ClosedFormTilesOf, GlossConvergesWithTheSquareOfTheSubtiles) {
  const LuminaireGeometry& g = field_->geometry();
  LightField even(g);
  for (int flat = 0; flat < g.sampling.cells(); ++flat) {
    CellImage image{g.measurement.width_px, g.measurement.height_px, static_cast<int>(channels()), {}, {}, {}};
    image.value.assign(image.plane() * channels(), 1.0F);
    ASSERT_TRUE(even.add(g.sampling.index(flat), std::move(image)));
  }
  const ClosedForm form(even);
  const Receiver receiver{{5, -8, 3 * g.planes.separation_mm}, Vec3(0.1, 0.2, -1).normalized()};
  const Vec3 eye = Vec3(-0.1, 0.3, -1).normalized();
  const Look look{.lobe = {static_cast<float>(eye.x()), static_cast<float>(eye.y()), static_cast<float>(eye.z()), 0.3F,
                           0.04F, 0.04F, 0.04F, LOBE_GGX},
                  .sees = {}};
  std::vector<double> at;
  for (const int division : {1, 2, 4, 8}) at.push_back(form.light(receiver, look, division).back());
  const double first = std::abs(at[0] - at[1]), second = std::abs(at[1] - at[2]), third = std::abs(at[2] - at[3]);
  EXPECT_GT(first, 0);
  EXPECT_NEAR(first / second, 4, 0.5);
  EXPECT_NEAR(second / third, 4, 0.5);
  const TileGrid grid(g.sampling);
  EXPECT_LE(std::abs(form.light(receiver, look, 0).back() - at[3]), lobe_error(grid, receiver, look.lobe, 0) * at[3]);
  EXPECT_LE(first, lobe_error(TileGrid(g.sampling), receiver, look.lobe, 1) * at[3]);
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
    const int division =
        gloss_division(grid, receivers_[k], lobe, light_is_even(appearance.look(k)), gloss_tolerance(lod));
    const std::vector<double> host = form.light(receivers_[k], appearance.look(k), division);
    const std::vector<double> light = magnitude.light(receivers_[k], {.lobe = lobe, .sees = {}}, division);
    for (std::size_t c = 0; c < host.size(); ++c) {
      const bool shines = c >= channels();
      const double value = shines ? gloss[k * outs + c - channels()] : e[k * channels() + c];
      const double off = std::abs(value - host[c]);
      // A lobe is in float: of its peak, which the tail may be far below.
      const double peak = shines ? 1e-6 * peak_of(lobe) * light[(c - channels()) % channels()] : 0;
      EXPECT_LE(off, peak + tolerance * light[c]) << "value " << c << " of " << name(k) << " division " << division
                                                  << " kind " << lobe.kind << " shape " << lobe.shape;
      double& most = worst[(shines ? "G " : "E ") + cases_[k].name];
      if (light[c] > 0) most = std::max(most, off / light[c]);
    }
  }
  if (std::getenv("LUMIFIELD_PRINT_ERRORS"))
    for (const auto& [which, error] : worst) std::printf("%-24s %.1e\n", which.c_str(), error);
}

TEST_P(ClosedFormTilesOf, KernelSeesTheTilesThatTheHostSees) {
  expect_as_host({{}, test::random_visibility(field_->geometry().sampling, receivers_.size(), ShadowWeighing::tile)},
                 1e-5);
}

TEST_P(ClosedFormTilesOf, KernelWeighsByTheMeanAsTheHost) {
  expect_as_host({{}, test::random_visibility(field_->geometry().sampling, receivers_.size(), ShadowWeighing::mean)},
                 1e-5);
}

TEST_P(ClosedFormTilesOf, KernelShinesAsTheHost) { expect_as_host({test::random_lobes(receivers_, false), {}}, 1e-4); }

TEST_P(ClosedFormTilesOf, KernelShinesInColourAndHalfShadowAsTheHost) {
  expect_as_host({test::random_lobes(receivers_, true),
                  test::random_visibility(field_->geometry().sampling, receivers_.size(), ShadowWeighing::tile)},
                 1e-4);
}

TEST_P(ClosedFormTilesOf, KernelKeepsToALevelOfDetail) {
  expect_as_host({test::random_lobes(receivers_, true),
                  test::random_visibility(field_->geometry().sampling, receivers_.size(), ShadowWeighing::tile)},
                 1e-4, 6);
}

}  // namespace
}  // namespace lumifield
