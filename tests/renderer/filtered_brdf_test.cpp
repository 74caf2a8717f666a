// Samples of what a receiver reflects, on the host: unbiased where they are not filtered, and as far off as they say;
// filtered, as far off as they say too, and nearer than plain ones of the same number.
#include "renderer/methods/filtered_brdf.h"

#include <cmath>
#include <gtest/gtest.h>

#include "renderer/methods/closed_form.h"
#include "renderer/methods/seen_tiles.h"
#include "tests/support/deviations.h"
#include "tests/support/sampling_cases.h"

namespace lumifield {
namespace {

using namespace test;

TEST(RayLight, IntegratesToTheClosedForm) {
  for (const BasisKind basis : {BasisKind::box, BasisKind::tent, BasisKind::bell, BasisKind::bspline2}) {
    const LightField field = sampled_luminaire(3, basis);
    const RayLight rays(field, false);
    for (const Case& c : {beyond, near_s, on_s, between}) {
      const ReceiverView view(field.geometry(), rays.basis(), c.receiver);
      std::vector<double> e(3, 0.0);
      const auto fine = [](const Vec3&) { return 0.05; };
      over_seen_tiles(view, fine, [&](const Vec2& u, const Vec3& direction, double solid_angle) {
        const std::vector<double> light = rays.radiance(view, u, 0);
        for (std::size_t k = 0; k < 3; ++k) e[k] += light[k] * std::max(c.receiver.n.dot(direction), 0.0) * solid_angle;
      });
      const std::vector<double> wanted = ClosedForm(field).irradiance(c.receiver);
      for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(e[k], wanted[k], 2e-4 * wanted[k]) << c.name;
    }
  }
}

TEST(RayLight, AveragedOverAFootprintKeepsTheLight) {
  // Of even cells: whatever the footprint, all rays to a receiver have the same light together.
  LightField field = sampled_luminaire();
  const LuminaireGeometry g = field.geometry();
  for (int k = 0; k < g.sampling.cells(); ++k) {
    CellImage even = *field.cell(g.sampling.index(k));
    std::ranges::fill(even.value, 1.0F + static_cast<float>(k % 3));
    ASSERT_TRUE(field.add(g.sampling.index(k), std::move(even)));
  }
  const RayLight rays(field, true);
  for (const Vec3& p : {Vec3(0, 0, 1e6), Vec3(30, 20, 150)}) {
    const ReceiverView view(g, rays.basis(), {p, {0, 0, -1}});
    const auto all = [&](double width) {
      double sum = 0;
      for (double x = -150.25; x < 151; x += 0.5)
        for (double y = -150.25; y < 151; y += 0.5) {
          const double slant2 = 1 + (Vec2(x, y) - p.head<2>()).squaredNorm() / (p.z() * p.z());
          sum += rays.radiance(view, {x, y}, width)[0] * std::pow(slant2, -1.5);
        }
      return sum;
    };
    const double exactly = all(0);
    EXPECT_GT(exactly, 0);
    for (const double width : {3.0, 7.9, 8.1, 12.0, 30.0, 60.0})
      EXPECT_NEAR(all(width), exactly, 0.01 * exactly) << width << " at " << p.z();
  }
}

TEST(FilteredBrdf, UnfilteredIsUnbiased) {
  const LightField field = sampled_luminaire();
  // Few of a grazing receiver's rays meet the lamp.
  for (const auto& [c, samples] :
       {std::pair(beyond, 40.0), {near_s, 40.0}, {on_s, 40.0}, {between, 40.0}, {grazing, 2000.0}}) {
    const Runs all =
        runs(field, {.method = Method::filtered_brdf, .samples = samples, .filter = false}, c.receiver, {}, 0, 0, 5000);
    const double reference = exact(field, c.receiver, {}, 0);
    EXPECT_LT(std::abs(all.mean - reference), 3.5 * all.error) << c.name << ' ' << reference;
    EXPECT_LT(all.error, 0.02 * reference) << c.name << ": else nothing is tested";
  }
}

TEST(FilteredBrdf, UnfilteredShinesAsTheReferenceDoes) {
  const LightField field = sampled_luminaire();
  for (const Case& c : {beyond, near_s, between})
    for (const auto& [kind, shape] : {std::pair(LOBE_PHONG, 50.0F), {LOBE_GGX, 0.09F}, {LOBE_GGX, 0.5F}}) {
      const Look look = shining(c.receiver, kind, shape);
      const Runs all =
          runs(field, {.method = Method::filtered_brdf, .samples = 40, .filter = false}, c.receiver, look, 1, 0, 1000);
      const double reference = exact(field, c.receiver, look, 1);
      EXPECT_LT(std::abs(all.mean - reference), 3.5 * all.error + 1e-3 * reference)
          << c.name << ' ' << kind << ' ' << shape;
      EXPECT_LT(all.error, 0.05 * reference) << c.name << ' ' << kind << ' ' << shape;
    }
}

TEST(FilteredBrdf, UnfilteredIsAsFarOffAsItStates) {
  const LightField field = sampled_luminaire();
  constexpr int seeds = 400;
  constexpr double samples = 100;
  for (const Case& c : {beyond, near_s, between})
    for (const auto& [kind, shape] : {std::pair(LOBE_NONE, 0.0F), {LOBE_PHONG, 20.0F}, {LOBE_GGX, 0.2F}}) {
      const Look look = kind == LOBE_NONE ? Look{} : shining(c.receiver, kind, shape);
      const std::size_t value = kind == LOBE_NONE ? 0 : 1;
      MethodSettings settings{
          .method = Method::filtered_brdf, .samples = samples, .sequence = PointSequence::twister, .filter = false};
      const double reference = exact(field, c.receiver, look, value);
      const Runs all = runs(field, settings, c.receiver, look, value, reference, seeds);
      const double stated =
          make_host_method(field, settings).value()->estimate(c.receiver, 17, look).value().stated_error[value];
      // The mean's square is all that independent samples do better.
      const double deviation = std::sqrt(stated * stated - reference * reference / samples);
      EXPECT_GT(all.rms, deviation_bound(seeds, -1) * deviation) << c.name << ' ' << kind;
      EXPECT_LT(all.rms, deviation_bound(seeds, 1) * deviation) << c.name << ' ' << kind;
      settings.sequence = PointSequence::halton;
      EXPECT_LT(runs(field, settings, c.receiver, look, value, reference, 100).rms, all.rms) << c.name << ' ' << kind;
    }
}

/// Visits a case of irradiance and two of gloss at each of three receivers.
template <class Visit>
void over_lit_and_shining(const Visit& visit) {
  for (const Case& c : {beyond, near_s, between})
    for (const auto& [kind, shape] : {std::pair(LOBE_NONE, 0.0F), {LOBE_PHONG, 50.0F}, {LOBE_GGX, 0.09F}}) {
      const Look look = kind == LOBE_NONE ? Look{} : shining(c.receiver, kind, shape);
      visit(std::string(c.name) + (kind == LOBE_NONE    ? ", lit"
                                   : kind == LOBE_PHONG ? ", Phong"
                                                        : ", GGX"),
            c.receiver, look, kind == LOBE_NONE ? std::size_t(0) : std::size_t(1));
    }
}

TEST(FilteredBrdf, FilteredIsNearerThanPlain) {
  const LightField field = sampled_luminaire();
  constexpr int seeds = 400;
  for (const auto& [samples, on_the_whole] : {std::pair(10.0, 0.65), {40.0, 0.85}, {200.0, 0.95}}) {
    double gloss = 0;  // logarithms of what is left of the error
    int of_gloss = 0;
    over_lit_and_shining([&](const std::string& name, const Receiver& receiver, const Look& look, std::size_t value) {
      const double reference = exact(field, receiver, look, value);
      MethodSettings settings{.method = Method::filtered_brdf, .samples = samples};
      const double filtered = runs(field, settings, receiver, look, value, reference, seeds).rms;
      settings.filter = false;
      const double left = filtered / runs(field, settings, receiver, look, value, reference, seeds).rms;
      // Of a lobe that the lamp fills few samples are few enough, which is 1.15 at most; elsewhere averages win.
      EXPECT_LT(left, value == 0 ? 0.9 : 1.2) << name << ' ' << samples;
      if (value == 0) return;
      gloss += std::log(left);
      ++of_gloss;
    });
    EXPECT_LT(std::exp(gloss / of_gloss), on_the_whole) << samples;
  }
}

TEST(FilteredBrdf, FilteredIsAsFarOffAsItStates) {
  const LightField field = sampled_luminaire();
  constexpr int seeds = 400;
  for (const double samples : {10.0, 40.0, 200.0})
    over_lit_and_shining([&](const std::string& name, const Receiver& receiver, const Look& look, std::size_t value) {
      const double reference = exact(field, receiver, look, value);
      MethodSettings settings{.method = Method::filtered_brdf, .samples = samples, .sequence = PointSequence::twister};
      const Runs all = runs(field, settings, receiver, look, value, reference, seeds);
      const double stated =
          make_host_method(field, settings).value()->estimate(receiver, 17, look).value().stated_error[value];
      // Deviation and bias; the mean's square is all that independent samples do better than is stated.
      const double deviation = all.error * std::sqrt(seeds - 1.0);
      const double off =
          std::sqrt(deviation * deviation + all.mean * all.mean / samples) + std::abs(all.mean - reference);
      std::printf("STA %s %g %.3f\n", name.c_str(), samples, stated / off);
      EXPECT_NEAR(stated, off, 0.2 * off) << name << ' ' << samples;
      settings.sequence = PointSequence::halton;
      EXPECT_LT(runs(field, settings, receiver, look, value, reference, 100).rms, stated) << name << ' ' << samples;
    });
}

TEST(FilteredBrdf, ReceiversErrEachInItsOwnWay) {
  const LightField field = sampled_luminaire();
  constexpr int receivers = 400;
  for (const Case& c : {beyond, near_s})
    for (const auto& [kind, shape] : {std::pair(LOBE_NONE, 0.0F), {LOBE_GGX, 0.09F}}) {
      const Look look = kind == LOBE_NONE ? Look{} : shining(c.receiver, kind, shape);
      const std::size_t value = kind == LOBE_NONE ? 0 : 1;
      const double reference = exact(field, c.receiver, look, value);
      const auto form =
          make_host_method(field, {.method = Method::filtered_brdf, .samples = 64, .filter = false}).value();
      double mean = 0, squares = 0;
      for (std::uint32_t k = 0; k < receivers; ++k) {
        const double error = form->light(c.receiver, k, look).value()[value] - reference;
        mean += error / receivers;
        squares += error * error / receivers;
      }
      // Of one seed: they differ by their turns alone, and share how far from the lobe's axis their points are.
      EXPECT_LT(std::abs(mean), 0.5 * std::sqrt(squares)) << c.name << ' ' << kind;
    }
}

TEST(FilteredBrdf, BiasOfTheFilterFallsWithTheSamples) {
  const LightField field = sampled_luminaire();
  for (const Case& c : {beyond, near_s, on_s, between})
    for (const auto& [kind, shape] : {std::pair(LOBE_NONE, 0.0F), {LOBE_PHONG, 50.0F}, {LOBE_GGX, 0.09F}}) {
      const Look look = kind == LOBE_NONE ? Look{} : shining(c.receiver, kind, shape);
      const std::size_t value = kind == LOBE_NONE ? 0 : 1;
      const double reference = exact(field, c.receiver, look, value);
      const Runs all =
          runs(field, {.method = Method::filtered_brdf, .samples = 20000}, c.receiver, look, value, reference, 10);
      EXPECT_LT(std::abs(all.mean - reference), 3.5 * all.error + 5e-3 * reference) << c.name << ' ' << kind;
    }
}

TEST(FilteredBrdf, OfAnEyeBelowTheSurfaceOrALuminaireWithoutCellsIsDark) {
  const LightField field = sampled_luminaire();
  Look look = shining(beyond.receiver, LOBE_GGX, 0.1F);
  look.lobe.eye_z = -look.lobe.eye_z;
  const auto form = make_host_method(field, {.method = Method::filtered_brdf}).value();
  const std::vector<double> values = form->light(beyond.receiver, 0, look).value();
  EXPECT_GT(values[0], 0);
  EXPECT_EQ(values[1], 0);
  const LightField none(field.geometry());
  const Estimate dark =
      make_host_method(none, {.method = Method::filtered_brdf}).value()->estimate(beyond.receiver, 0, look).value();
  EXPECT_EQ(dark.irradiance, std::vector<double>(2, 0.0));
  EXPECT_EQ(dark.stated_error, std::vector<double>(2, 0.0));
}

}  // namespace
}  // namespace lumifield
