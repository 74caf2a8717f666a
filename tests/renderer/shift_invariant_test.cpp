// Spotlights at the cells' centres, on the host, against the closed form.
#include "renderer/shift_invariant/shift_invariant.h"

#include <cmath>
#include <gtest/gtest.h>
#include <random>

#include "renderer/methods/closed_form.h"
#include "renderer/study/definition_quadrature.h"
#include "renderer/study/synthetic_luminaire.h"
#include "tests/support/closed_form_cases.h"

namespace lumifield {
namespace {

/// Each cell alone, as closed forms of its values and of their magnitude.
struct LoneCell {
  Vec2 u_mm;
  std::unique_ptr<ClosedForm> form, magnitude;
};

std::vector<LoneCell> lone_cells(const LightField& field) {
  std::vector<LoneCell> cells;
  const Sampling& sampling = field.geometry().sampling;
  for (int flat = 0; flat < sampling.cells(); ++flat) {
    const CellIndex index = sampling.index(flat);
    const auto image = field.cell(index);
    if (!image) continue;
    LightField alone(field.geometry()), magnitude(field.geometry());
    CellImage absolute = *image;
    for (float& v : absolute.value) v = std::abs(v);
    EXPECT_TRUE(alone.add(index, image));
    EXPECT_TRUE(magnitude.add(index, std::move(absolute)));
    cells.push_back(
        {sampling.cell_center_mm(index), std::make_unique<ClosedForm>(alone), std::make_unique<ClosedForm>(magnitude)});
  }
  return cells;
}

/// The closed form of a receiver that faces U has no W1 terms, and k = δ+Δ. Then k is that of the receiver.
std::vector<double> without_w1(const std::vector<LoneCell>& cells, const Receiver& at, std::size_t channels,
                               bool magnitude) {
  std::vector<double> sum(channels, 0.0);
  const double z = lit_height_mm(at.p_mm.z());
  if (!(z > 0)) return sum;
  for (const LoneCell& cell : cells) {
    const double k = at.n.x() * (cell.u_mm.x() - at.p_mm.x()) + at.n.y() * (cell.u_mm.y() - at.p_mm.y()) - at.n.z() * z;
    const auto e = (magnitude ? *cell.magnitude : *cell.form).irradiance({at.p_mm, {0, 0, -1}});
    for (std::size_t c = 0; c < channels; ++c) sum[c] += e[c] * std::max(k, 0.0) / z;
  }
  return sum;
}

/// Σ|the terms of k|, which k rounds with, over k's of all cells and the magnitude: near U and at grazing angles.
double rounding_of_k(const std::vector<LoneCell>& cells, const Receiver& at, std::size_t c) {
  double sum = 0;
  const double z = lit_height_mm(at.p_mm.z());
  if (!(z > 0)) return 0;
  for (const LoneCell& cell : cells) {
    const Vec3 to(cell.u_mm.x() - at.p_mm.x(), cell.u_mm.y() - at.p_mm.y(), -z);
    sum += cell.magnitude->irradiance({at.p_mm, {0, 0, -1}})[c] * at.n.cwiseAbs().dot(to.cwiseAbs()) / z;
  }
  return 1e-15 * sum;
}

class ShiftInvariantOfBases : public testing::TestWithParam<std::tuple<BasisKind, int>> {};
INSTANTIATE_TEST_SUITE_P(All, ShiftInvariantOfBases,
                         testing::Combine(testing::Values(BasisKind::box, BasisKind::tent, BasisKind::bell,
                                                          BasisKind::bspline2),
                                          testing::Values(1, 3)));

TEST_P(ShiftInvariantOfBases, IsTheClosedFormWithoutItsTermsInW1) {
  const auto [basis, channels] = GetParam();
  const LightField field = random_luminaire(basis, channels, 3);
  const std::vector<LoneCell> cells = lone_cells(field);
  const ShiftInvariant form(field, {});
  int lit = 0;
  for (const ReceiverCase& each : receiver_cases(field.geometry(), 4)) {
    const Receiver at{each.p_mm, each.n};
    const auto e = form.irradiance(at, 0).value();
    const auto n = static_cast<std::size_t>(channels);
    const auto wanted = without_w1(cells, at, n, false), magnitude = without_w1(cells, at, n, true);
    for (std::size_t c = 0; c < n; ++c) {
      EXPECT_NEAR(e[c], wanted[c], 1e-12 * magnitude[c] + rounding_of_k(cells, at, c)) << each.name;
      lit += wanted[c] != 0;
    }
  }
  EXPECT_GT(lit, 90 * channels);
}

TEST_P(ShiftInvariantOfBases, IsOffTheClosedFormByNoMoreThanItStates) {
  const auto [basis, channels] = GetParam();
  const LightField field = random_luminaire(basis, channels, 5);
  const std::vector<LoneCell> cells = lone_cells(field);
  const ClosedForm exact(field);
  for (const SpotLookUp look_up : {SpotLookUp::weighted, SpotLookUp::textured}) {
    const ShiftInvariant form(field, {.look_up = look_up});
    int off = 0;
    for (const ReceiverCase& each : receiver_cases(field.geometry(), 6)) {
      const Receiver at{each.p_mm, each.n};
      const Estimate stated = form.estimate(at, 0).value();
      const auto right = exact.irradiance(at), magnitude = without_w1(cells, at, right.size(), true);
      for (std::size_t c = 0; c < right.size(); ++c) {
        const double error = std::abs(stated.irradiance[c] - right[c]);
        EXPECT_LE(error, stated.stated_error[c] + 1e-12 * magnitude[c] + rounding_of_k(cells, at, c)) << each.name;
        off += error > 1e-3 * std::abs(right[c]);
      }
    }
    EXPECT_GT(off, 60 * channels) << "there is something to state";
  }
}

/// Eq. 14 as it is printed, with 1/g = δ²/cos⁴θ, the average by the midpoint rule.
TEST(ShiftInvariant, IsTheSumOfSpotlights) {
  const LightField field = make_luminaire({.name = "small",
                                           .separation_mm = 60,
                                           .spacing_mm = 16,
                                           .columns = 3,
                                           .rows = 2,
                                           .pixels = 70,
                                           .pixel_mm = 1,
                                           .lobes = 8,
                                           .spread_mm = 30,
                                           .least_width_mm = 4,
                                           .greatest_width_mm = 12});
  const LuminaireGeometry& g = field.geometry();
  const Basis basis(g.sampling.basis);
  const Vec3 p(12, -7, 160), n = Vec3(0.3, -0.2, -1).normalized();
  const Vec2 a = g.sampling.spacing_mm;
  const double area = a.prod(), delta = g.planes.separation_mm, r = (p.z() - delta) / p.z(), t = delta / p.z();
  double sum = 0;
  for (int flat = 0; flat < g.sampling.cells(); ++flat) {
    const Vec2 u_m = g.sampling.cell_center_mm(g.sampling.index(flat));
    const auto image = field.cell(g.sampling.index(flat));
    const Vec3 to = p - Vec3(u_m.x(), u_m.y(), 0);
    const double d = to.norm(), cosine = to.z() / d, facing = -n.dot(to) / d;
    double average = 0;
    constexpr int points = 1200;
    for (int k = 0; k < points * points; ++k) {
      const Vec2 tau = Vec2(k % points + 0.5, k / points + 0.5) * (2.0 / points) - Vec2(1, 1);
      const Vec2 s = p.head<2>() * t + (u_m + a.cwiseProduct(tau)) * r;
      const Vec2 px = (s - g.measurement.corner_mm()).cwiseQuotient(g.measurement.pixel_mm);
      if (px.minCoeff() < 0 || px.x() >= g.measurement.width_px || px.y() >= g.measurement.height_px) continue;
      average += image->at(0, int(px.x()), int(px.y())) * basis(tau.x()) * basis(tau.y()) * 4.0 / (points * points) *
                 delta * delta / std::pow(cosine, 4);
    }
    sum += area * cosine * facing / (d * d) * average;
  }
  EXPECT_NEAR(ShiftInvariant(field, {}).irradiance({p, n}, 0).value()[0], sum, 1e-4 * sum);
}

/// ∫τ²φ of the bell is 1/8: over w pixels a spacing a look-up as wide is at 4^ℓ/4 = w²/8.
TEST(SpotImage, ALookUpIsAsWideAsTheBasis) {
  EXPECT_NEAR(spot_level(Basis(BasisKind::bell), {8, 4}, 9), std::log2(8 / std::sqrt(2)), 1e-12);
  EXPECT_NEAR(spot_level(Basis(BasisKind::bspline2), {-8, 4}, 9), 3, 1e-12);
  EXPECT_EQ(spot_level(Basis(BasisKind::bell), {1, 1}, 9), 0);
  EXPECT_EQ(spot_level(Basis(BasisKind::bell), {1e6, 1}, 5), 5);
  EXPECT_EQ(spot_level(Basis(BasisKind::bell), {0, 0}, 5), 0);
}

TEST(SpotImage, LooksUpAsTexturesDo) {
  CellImage image{4, 4, 1, {}, {}, {}};
  for (int k = 0; k < 16; ++k) image.value.push_back(static_cast<float>(k));
  const SpotImage levels(image);
  EXPECT_EQ(levels.look_up(0, {1.5, 2.5}, 0), 9) << "a texel's centre";
  EXPECT_EQ(levels.look_up(0, {2, 2.5}, 0), 9.5);
  EXPECT_EQ(levels.look_up(0, {1, 1}, 1), 2.5) << "the mean of 0, 1, 4, 5";
  EXPECT_EQ(levels.look_up(0, {2, 1}, 1), 3.5);
  EXPECT_EQ(levels.look_up(0, {2, 2}, 2), 7.5);
  EXPECT_EQ(levels.look_up(0, {2, 2}, 1.5), 7.5);
  EXPECT_EQ(levels.look_up(0, {0, 0.5}, 0), 0) << "half of pixel 0, and half of nothing";
  EXPECT_EQ(levels.look_up(0, {4, 3.5}, 0), 7.5);
  EXPECT_EQ(levels.look_up(0, {-1e30, 1e30}, 1), 0);
}

/// A smooth image's look-up is nearly its average.
TEST(ShiftInvariant, ATexturedLookUpIsNearTheAverageWhereTheImageIsSmooth) {
  const LightField field = make_luminaire({.name = "smooth",
                                           .separation_mm = 60,
                                           .spacing_mm = 8,
                                           .columns = 4,
                                           .rows = 3,
                                           .pixels = 80,
                                           .pixel_mm = 1,
                                           .lobes = 6,
                                           .spread_mm = 20,
                                           .least_width_mm = 15,
                                           .greatest_width_mm = 20});
  const ShiftInvariant weighted(field, {}), textured(field, {.look_up = SpotLookUp::textured});
  for (const double z : {30.0, 60.0, 62.0, 100.0, 400.0})
    for (const Vec2& at : {Vec2(0, 0), Vec2(0.1, -0.05)}) {
      const Receiver receiver{{at.x() * z, at.y() * z, z}, Vec3(0.1, 0.2, -1).normalized()};
      const double e = weighted.irradiance(receiver, 0).value()[0];
      EXPECT_NEAR(textured.irradiance(receiver, 0).value()[0], e, 0.01 * e) << z;
    }
}

TEST(ShiftInvariant, CountsACutSupportByItsCentre) {
  const LightField field = make_luminaire({.name = "one",
                                           .separation_mm = 60,
                                           .spacing_mm = 16,
                                           .columns = 1,
                                           .rows = 1,
                                           .pixels = 70,
                                           .pixel_mm = 1,
                                           .lobes = 3,
                                           .spread_mm = 10,
                                           .least_width_mm = 15,
                                           .greatest_width_mm = 20});
  const ShiftInvariant form(field, {});
  const ClosedForm exact(field);
  // The horizon 4 mm to either side of the centre: n·(u − p) = 0.97 (u_x ∓ 4).
  const auto at = [](double x) { return Receiver{{x, 0, 100}, Vec3(1, 0, 0)}; };
  EXPECT_GT(form.irradiance(at(-4), 0).value()[0], 0);
  EXPECT_EQ(form.irradiance(at(4), 0).value()[0], 0);
  EXPECT_GT(exact.irradiance(at(4))[0], 0) << "what is above the horizon beside the centre";
  EXPECT_GE(form.estimate(at(4), 0).value().stated_error[0], exact.irradiance(at(4))[0]);
}

}  // namespace
}  // namespace lumifield
