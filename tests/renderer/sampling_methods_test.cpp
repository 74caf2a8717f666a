// The methods that sample, on the host: unbiased where they say so, biased where they say so, and as far off as they
// say. One small luminaire; receivers far, near, on and before S.
#include <cmath>
#include <gtest/gtest.h>
#include <random>

#include "renderer/methods/host_method.h"
#include "renderer/methods/receiver_view.h"
#include "renderer/methods/sampled_cell.h"
#include "renderer/sampling/piecewise_constant_2d.h"
#include "renderer/sampling/sample_counts.h"
#include "tests/support/deviations.h"
#include "tests/support/sampling_cases.h"

namespace lumifield {
namespace {

using namespace test;

/// Mean and standard error over seeds, of one channel.
struct Mean {
  double value, error;
  double off(double reference) const { return (value - reference) / error; }
};
Mean mean_over_seeds(const LightField& field, MethodSettings settings, const Receiver& receiver, int seeds) {
  double sum = 0, squares = 0;
  for (int k = 0; k < seeds; ++k) {
    settings.seed = static_cast<std::uint32_t>(k + 1);
    const double e = make_host_method(field, settings).value()->irradiance(receiver, 17).value()[0];
    sum += e;
    squares += e * e;
  }
  const double mean = sum / seeds;
  return {mean, std::sqrt(std::max(squares / seeds - mean * mean, 0.0) / (seeds - 1))};
}

double reference(const LightField& field, const Receiver& receiver) {
  return ClosedForm(field).irradiance(receiver)[0];
}

TEST(PositionDependent, IsUnbiasedAtAnyNumberOfSamples) {
  const LightField field = sampled_luminaire();
  for (const Case& c : {far_away, beyond, near_s, on_s, between, grazing})
    for (const double k : {16.0, 50.0, 200.0}) {
      const Mean mean = mean_over_seeds(field, {.method = Method::position_dependent, .samples = k}, c.receiver, 1000);
      EXPECT_LT(std::abs(mean.off(reference(field, c.receiver))), 3) << c.name << ", K = " << k;
      EXPECT_GT(mean.error, 0);
    }
}

TEST(PositionDependent, StaysUnbiasedWithABoundOnTheSamplesOfACellAndWithTheTwister) {
  const LightField field = sampled_luminaire();
  for (const PointSequence sequence : {PointSequence::halton, PointSequence::twister}) {
    const Mean mean =
        mean_over_seeds(field, {.method = Method::position_dependent, .samples = 50, .k_max = 3, .sequence = sequence},
                        beyond.receiver, 400);
    EXPECT_LT(std::abs(mean.off(reference(field, beyond.receiver))), 3);
  }
}

/// What the published estimator's mean is, pixel by pixel: cells that get no sample are lost, and in the others
/// ∫ F C/(K_m wanted) K_m drawn, drawn and wanted the densities of the pair of cdfs and of the image in the box.
double printed_mean(const LightField& field, double k, const Receiver& receiver) {
  const LuminaireGeometry& g = field.geometry();
  const Basis basis(g.sampling.basis);
  const ReceiverView view(g, basis, receiver);
  const std::vector<SampledCell> cells = sampled_cells(field, luminance_image);
  std::vector<double> a;
  for (const SampledCell& cell : cells)
    a.push_back(cell.importance.integral(cell.importance.clipped(view.box(cell.u_mm))));
  const std::vector<int> counts = nearest_counts(expected_counts(a, k));
  double mean = 0;
  for (std::size_t m = 0; m < cells.size(); ++m) {
    if (counts[m] == 0) continue;
    const PiecewiseConstant2D table(cells[m].importance);
    const PixelBox box = cells[m].importance.clipped(view.box(cells[m].u_mm));
    // Midpoints: the densities are constant on pixels, of which a support shows a few dozen.
    constexpr int n = 400;
    const double width = (box.x1 - box.x0) / n, height = (box.y1 - box.y0) / n;
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i) {
        const Vec2 at(box.x0 + (i + 0.5) * width, box.y0 + (j + 0.5) * height);
        mean += width * height * view.weight(cells[m].u_mm, view.tau(cells[m].u_mm, at)) * a[m] *
                table.pdf(at.x(), at.y(), box) / std::abs(view.rate().prod());
      }
  }
  return mean;
}

TEST(PositionDependentPrinted, IsBiasedByWhatItStates) {
  const LightField field = sampled_luminaire();
  for (const double k : {16.0, 50.0, 200.0}) {
    const MethodSettings settings{.method = Method::position_dependent_printed, .samples = k};
    double worst = 0;
    for (const Case& c : {far_away, beyond, near_s}) {
      const Mean mean = mean_over_seeds(field, settings, c.receiver, 1000);
      const double exact = reference(field, c.receiver), biased = printed_mean(field, k, c.receiver);
      const Estimate one = make_host_method(field, settings).value()->estimate(c.receiver, 17).value();
      EXPECT_LT(std::abs(mean.off(biased)), 4) << c.name << ", K = " << k;
      EXPECT_LT(std::abs(biased - exact), one.stated_error[0]) << c.name << ", K = " << k;
      worst = std::max(worst, std::abs(mean.off(exact)));
    }
    EXPECT_GT(worst, 3) << "K = " << k;
  }
  // Of so many samples the deviation is nothing: what is stated is the bias.
  constexpr double many = 1e6;
  const auto method = make_host_method(field, {.method = Method::position_dependent_printed, .samples = many}).value();
  for (const Case& c : {far_away, beyond, near_s}) {
    const double exact = reference(field, c.receiver), bias = std::abs(printed_mean(field, many, c.receiver) - exact);
    const double stated = method->estimate(c.receiver, 17).value().stated_error[0];
    EXPECT_GT(stated, bias) << c.name;
    EXPECT_LT(stated, bias + 0.003 * exact) << c.name;
  }
}

TEST(PositionDependentPrinted, RefusesWhatThePrintHasNoAnswerFor) {
  const LightField field = sampled_luminaire();
  const MethodSettings settings{.method = Method::position_dependent_printed};
  const auto method = make_host_method(field, settings).value();
  EXPECT_FALSE(method->irradiance(between.receiver, 0));
  EXPECT_FALSE(method->irradiance({{3, -2, 60 + 1e-6}, {0, 0, -1}}, 0));
  EXPECT_TRUE(method->irradiance(on_s.receiver, 0));
  EXPECT_EQ(method->irradiance({{3, -2, -5}, {0, 0, 1}}, 0).value()[0], 0);

  LightField negative = field;
  CellImage image = *field.cell({1, 2});
  image.value[40 * 7 + 3] = -0.5F;
  ASSERT_TRUE(negative.add({1, 2}, std::move(image)));
  const auto refused = make_host_method(negative, settings);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().where, "cell (1, 2), pixel (3, 7)");
}

TEST(UniformBox, IsUnbiased) {
  const LightField field = sampled_luminaire();
  for (const Case& c : {far_away, near_s, on_s, between})
    for (const double k : {5.0, 50.0}) {
      const Mean mean = mean_over_seeds(field, {.method = Method::uniform_box, .samples = k}, c.receiver, 1000);
      EXPECT_LT(std::abs(mean.off(reference(field, c.receiver))), 3) << c.name << ", K = " << k;
    }
}

TEST(PrecomputedLights, AreUnbiasedOverSeeds) {
  const LightField field = sampled_luminaire();
  for (const Case& c : {far_away, beyond, between}) {
    const Mean mean = mean_over_seeds(field, {.method = Method::precomputed_lights, .samples = 300}, c.receiver, 1000);
    EXPECT_LT(std::abs(mean.off(reference(field, c.receiver))), 3) << c.name;
  }
  const auto method = make_host_method(field, {.method = Method::precomputed_lights}).value();
  EXPECT_FALSE(method->irradiance(on_s.receiver, 0)) << "no light is seen on S";
}

/// Σ_m E_m²/κ_m: by how much the variance of independent samples is less than the mean square that is stated, but for
/// what the rounding of κ_m adds.
double mean_squares(const LightField& field, Method which, double k, const Receiver& receiver) {
  const ReceiverView view(field.geometry(), Basis(field.geometry().sampling.basis), receiver);
  const std::vector<SampledCell> cells = sampled_cells(field);
  std::vector<double> share;
  for (const SampledCell& cell : cells)
    share.push_back(which == Method::uniform_box ? 1
                    : which == Method::precomputed_lights
                        ? cell.importance.total()
                        : cell.importance.integral(cell.importance.clipped(view.box(cell.u_mm))));
  const std::vector<double> kappa = expected_counts(share, k);
  double sum = 0;
  for (std::size_t m = 0; m < cells.size(); ++m) {
    LightField alone(field.geometry());
    EXPECT_TRUE(alone.add(field.geometry().sampling.index(static_cast<int>(cells[m].number)), *cells[m].image));
    if (kappa[m] > 0) sum += std::pow(reference(alone, receiver), 2) / kappa[m];
  }
  return sum;
}

TEST(SamplingMethods, AreAsFarOffAsTheyState) {
  // Independent points, for which the stated deviation is meant; the Halton sequence does better.
  const LightField field = sampled_luminaire();
  for (const Method which : {Method::position_dependent, Method::uniform_box, Method::precomputed_lights})
    for (const Case& c : {far_away, beyond, between}) {
      double squares = 0, halton = 0, stated = 0;
      const double exact = reference(field, c.receiver);
      constexpr int seeds = 400;
      constexpr double samples = 200;
      for (int seed = 1; seed <= seeds; ++seed) {
        MethodSettings settings{.method = which, .samples = samples, .seed = std::uint32_t(seed)};
        const auto even = make_host_method(field, settings).value()->irradiance(c.receiver, 3).value();
        halton += std::pow(even[0] - exact, 2) / seeds;
        settings.sequence = PointSequence::twister;
        const auto form = make_host_method(field, settings).value();
        squares += std::pow(form->irradiance(c.receiver, 3).value()[0] - exact, 2) / seeds;
        if (seed == 1) stated = form->estimate(c.receiver, 3).value().stated_error[0];
      }
      const double least = std::sqrt(stated * stated - mean_squares(field, which, samples, c.receiver));
      EXPECT_GT(least, 0.5 * stated) << to_string(which) << ' ' << c.name;
      EXPECT_GT(std::sqrt(squares), deviation_bound(seeds, -1) * least) << to_string(which) << ' ' << c.name;
      EXPECT_LT(std::sqrt(squares), deviation_bound(seeds, 1) * stated) << to_string(which) << ' ' << c.name;
      // In the images as a whole the sequence' regularity is lost.
      if (which != Method::precomputed_lights) {
        EXPECT_LT(halton, squares) << to_string(which) << ' ' << c.name;
      }
    }
}

TEST(SamplingMethods, CarryColourAndNegativeValues) {
  LightField field = sampled_luminaire(3);
  CellImage image = *field.cell({1, 1});
  for (std::size_t k = 0; k < image.value.size(); k += 3) image.value[k] *= -0.7F;
  ASSERT_TRUE(field.add({1, 1}, std::move(image)));
  const std::vector<double> exact = ClosedForm(field).irradiance(beyond.receiver);
  for (const Method which : {Method::position_dependent, Method::uniform_box, Method::precomputed_lights}) {
    const Estimate one =
        make_host_method(field, {.method = which, .samples = 100000}).value()->estimate(beyond.receiver, 3).value();
    for (std::size_t c = 0; c < 3; ++c) {
      EXPECT_NEAR(one.irradiance[c], exact[c], 4 * one.stated_error[c]) << to_string(which) << ' ' << c;
      EXPECT_LT(one.stated_error[c], 0.05 * exact[c]);
    }
  }
}

TEST(FarField, IsRightFarAwayAndBoundsItsErrorNearby) {
  const LightField field = sampled_luminaire();
  const auto method = make_host_method(field, {.method = Method::far_field}).value();
  double before = HUGE_VAL;
  for (const double d : {300.0, 3e3, 3e4, 3e5}) {
    const Receiver receiver{{0.11 * d, -0.07 * d, d}, {0, 0, -1}};
    const double exact = reference(field, receiver);
    const Estimate one = method->estimate(receiver, 0).value();
    EXPECT_LE(std::abs(one.irradiance[0] - exact), one.stated_error[0] + 1e-12 * exact) << d;
    const double relative = one.stated_error[0] / exact;
    EXPECT_LT(relative, 1.01 * before) << d;
    before = relative;
  }
  EXPECT_LT(before, 0.2);

  // At a point of the table the far field is exact but for size/d.
  const double d = 1e7;
  const Receiver receiver{{4 * d / 60, -6 * d / 60, d}, {0, 0, -1}};
  EXPECT_NEAR(method->irradiance(receiver, 0).value()[0] / reference(field, receiver), 1, 1e-4);
  EXPECT_EQ(method->irradiance({{0, 0, -10}, {0, 0, 1}}, 0).value()[0], 0);
}

TEST(FarField, BoundsWhatItsTableLeavesOutOfABoxBesideThePixels) {
  // Spacing and pixels have no common measure: the table's points lie anywhere to the slope's breaks.
  LuminaireGeometry g;
  g.planes.separation_mm = 60;
  g.sampling = {BasisKind::box, {7.3, 6.1}, 2, 2, {0.37, -0.21}};
  g.measurement = {40, 30, {1, 1.3}, {0.11, 0.43}};
  g.channels = {"Y"};
  std::mt19937 random(5);
  std::uniform_real_distribution<float> value(0, 1);
  LightField field(g);
  for (int k = 0; k < 4; ++k) {
    CellImage image{40, 30, 1, {}, {}, {}};
    for (int i = 0; i < 1200; ++i) image.value.push_back(value(random) < 0.9F ? 0.0F : 1.0F);
    ASSERT_TRUE(field.add(g.sampling.index(k), std::move(image)));
  }
  const auto method = make_host_method(field, {.method = Method::far_field}).value();
  const double d = 1e8;  // so far that the table alone is in error
  double most = 0;
  for (int k = 0; k < 4000; ++k) {
    const Vec2 q(18 * std::sin(0.7 * k), 17 * std::cos(1.1 * k + 0.2));
    const Receiver at{{q.x() * d / 60, q.y() * d / 60, d}, {0, 0, -1}};
    const Estimate one = method->estimate(at, 0).value();
    const double off = std::abs(one.irradiance[0] - reference(field, at));
    EXPECT_LE(off, one.stated_error[0] + 1e-9 * one.irradiance[0]) << q.transpose();
    if (one.stated_error[0] > 0) most = std::max(most, off / one.stated_error[0]);
  }
  EXPECT_GT(most, 0.2) << "else the bound would say nothing";
}

TEST(HostMethod, RefusesSettingsThatMakeNoSense) {
  const LightField field = sampled_luminaire();
  EXPECT_FALSE(make_host_method(field, {.method = Method::position_dependent, .samples = 0}));
  EXPECT_FALSE(make_host_method(field, {.method = Method::position_dependent, .samples = std::nan("")}));
  EXPECT_FALSE(make_host_method(field, {.method = Method::uniform_box, .samples = 1e8}));
  EXPECT_FALSE(make_host_method(field, {.method = Method::precomputed_lights, .samples = 1e7}));
  EXPECT_FALSE(make_host_method(field, {.method = Method::closed_form, .lod = -1}));
  EXPECT_FALSE(make_host_method(field, {.method = Method::uniform_box, .k_max = -1}));
}

TEST(HostMethod, NamesAreUniqueAndReadBack) {
  for (const MethodInfo& each : methods()) {
    EXPECT_EQ(method_from_string(each.name), each.method);
    EXPECT_EQ(info(each.method).name, each.name);
  }
  EXPECT_FALSE(method_from_string("closed form"));
}

}  // namespace
}  // namespace lumifield
